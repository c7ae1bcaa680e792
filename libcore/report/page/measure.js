// Distances between points of the surface: two clicks measure, a third begins anew.
'use strict';

const PARALLEL = Math.cos((3 * Math.PI) / 180); // planes that differ by less have one distance

class Measurement {
    // `overlay` is an SVG over the canvas, `readout` the element that says the distance; plane_of(face) gives
    // [nx, ny, nz, w] or null.
    constructor(viewer, overlay, readout, plane_of) {
        Object.assign(this, { viewer, overlay, readout, plane_of, picks: [] });
    }

    click(x, y) {
        const hit = this.viewer.pick(x, y);
        if (!hit) return;
        if (this.picks.length === 2) this.picks = [];
        this.picks.push(hit);
        this.say();
        this.draw();
    }

    clear() {
        this.picks = [];
        this.say();
        this.draw();
    }

    distance() {
        return this.picks.length === 2 ? length(subtract(this.picks[1].point, this.picks[0].point)) : null;
    }

    // Between parallel planes, across them: from wall to wall, from floor to ceiling.
    plane_distance() {
        if (this.picks.length < 2 || !this.picks.every((p) => p.on_model)) return null;
        const [a, b] = this.picks.map((p) => this.plane_of(p.face));
        if (!a || !b || Math.abs(dot(a, b)) < PARALLEL) return null;
        const across = Math.abs(dot(a, this.picks[1].point) + a[3]);
        return across > 0.01 ? across : null; // [m]; two points of one plane are not apart
    }

    say() {
        const distance = this.distance();
        if (distance === null) {
            this.readout.textContent = this.picks.length ? 'Click a second point.' : 'Click two points to measure.';
            return;
        }
        const [dx, dy, dz] = subtract(this.picks[1].point, this.picks[0].point);
        const across = this.plane_distance();
        this.readout.textContent = `${distance.toFixed(3)} m  (height ${Math.abs(dy).toFixed(3)} m, level ${Math.hypot(dx, dz).toFixed(3)} m)` +
            (across === null ? '' : `  between the planes ${across.toFixed(3)} m`);
    }

    draw() {
        const places = this.picks.map((p) => this.viewer.project(p.point)).filter(Boolean);
        const dots = places.map(([x, y]) => `<circle cx="${x}" cy="${y}" r="5"/>`).join('');
        let line = '';
        if (places.length === 2) {
            const [[x0, y0], [x1, y1]] = places;
            line = `<line x1="${x0}" y1="${y0}" x2="${x1}" y2="${y1}"/>` +
                `<text x="${(x0 + x1) / 2}" y="${(y0 + y1) / 2 - 10}">${this.distance().toFixed(2)} m</text>`;
        }
        this.overlay.innerHTML = line + dots;
    }
}
