// A camera that turns about a target: drag to turn, shift-drag or two fingers to move, wheel or pinch to come nearer.
'use strict';

const VIEW_ANGLE = (50 * Math.PI) / 180;
const NEAREST = 0.4; // [m] from the target; the wheel then pushes the target ahead, so that one can walk through a room
const STEEPEST = (89 * Math.PI) / 180;

class Orbit {
    constructor(bounds) {
        this.bounds = bounds;
        this.home();
    }

    // From above one corner, the whole model in view.
    home() {
        const { min, max } = this.bounds;
        this.target = scale(add(min, max), 0.5);
        this.radius = Math.max(length(subtract(max, min)) / 2, 0.1);
        this.distance = (this.radius / Math.sin(VIEW_ANGLE / 2)) * 0.74; // corners may stick out, rooms rarely have them there
        this.yaw = (35 * Math.PI) / 180;
        this.pitch = (40 * Math.PI) / 180;
    }

    // As a person of the scan saw it: at `eye`, towards `forward`, upright.
    stand(eye, forward) {
        const back = scale(normalize(forward), -1);
        this.yaw = Math.atan2(back[0], back[2]);
        this.pitch = Math.max(-STEEPEST, Math.min(STEEPEST, Math.asin(back[1])));
        this.distance = 1;
        this.target = subtract(eye, this.axes().back);
    }

    axes() {
        const back = [Math.cos(this.pitch) * Math.sin(this.yaw), Math.sin(this.pitch), Math.cos(this.pitch) * Math.cos(this.yaw)];
        const right = [Math.cos(this.yaw), 0, -Math.sin(this.yaw)];
        return { right, up: cross(back, right), back };
    }

    eye() {
        return add(this.target, scale(this.axes().back, this.distance));
    }

    turn(dx, dy) {
        this.yaw -= dx * 0.006;
        this.pitch = Math.max(-STEEPEST, Math.min(STEEPEST, this.pitch + dy * 0.006));
    }

    // By pixels of an image that is `height` pixels high.
    move(dx, dy, height) {
        const { right, up } = this.axes();
        const step = (2 * this.distance * Math.tan(VIEW_ANGLE / 2)) / height;
        this.target = add(this.target, add(scale(right, -dx * step), scale(up, dy * step)));
    }

    zoom(factor) {
        const wanted = this.distance * factor;
        this.distance = Math.min(Math.max(wanted, NEAREST), 20 * this.radius);
        if (wanted < NEAREST) this.target = add(this.target, scale(this.axes().back, wanted - NEAREST));
    }

    clip_from_model(aspect) {
        const { right, up, back } = this.axes();
        const near = Math.max(0.02, this.distance * 0.02), far = this.distance + 3 * this.radius + 5;
        // An upright image is widened to what a square one shows, or a room would not fit on a phone.
        const angle = aspect >= 1 ? VIEW_ANGLE : 2 * Math.atan(Math.tan(VIEW_ANGLE / 2) / Math.max(aspect, 0.4));
        return multiply(perspective(angle, aspect, near, far), look(this.eye(), right, up, back));
    }

    // The direction behind a place of the image, both coordinates from -1 to 1, y upwards.
    ray(x, y, aspect) {
        const { right, up, back } = this.axes();
        const half = aspect >= 1 ? Math.tan(VIEW_ANGLE / 2) : Math.tan(VIEW_ANGLE / 2) / Math.max(aspect, 0.4);
        return normalize(add(add(scale(right, x * half * aspect), scale(up, y * half)), scale(back, -1)));
    }
}

// Joins the pointers and the wheel over `element` to the orbit. Calls changed() after every move and clicked(x, y) [px
// from the element's corner] for a press that moved no farther than a finger trembles.
function follow_pointers(element, orbit, changed, clicked) {
    const TREMBLE = 5; // [px]
    const pointers = new Map();
    let moved = 0;
    const spread = () => {
        const [a, b] = [...pointers.values()];
        return { x: (a.x + b.x) / 2, y: (a.y + b.y) / 2, size: Math.hypot(a.x - b.x, a.y - b.y) };
    };
    element.addEventListener('pointerdown', (event) => {
        if (pointers.size === 0) moved = 0;
        pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
        element.setPointerCapture(event.pointerId);
    });
    element.addEventListener('pointermove', (event) => {
        const last = pointers.get(event.pointerId);
        if (!last) return;
        const before = pointers.size === 2 ? spread() : null;
        const dx = event.clientX - last.x, dy = event.clientY - last.y;
        moved += Math.hypot(dx, dy);
        pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
        if (before) {
            const after = spread();
            moved += 2 * TREMBLE; // two fingers never click
            orbit.move(after.x - before.x, after.y - before.y, element.clientHeight);
            orbit.zoom(before.size / Math.max(after.size, 1));
        } else if (moved > TREMBLE) {
            if (event.shiftKey || event.buttons & 6) orbit.move(dx, dy, element.clientHeight);
            else orbit.turn(dx, dy);
        }
        changed();
    });
    const release = (event) => {
        const known = pointers.delete(event.pointerId);
        if (known && event.type === 'pointerup' && pointers.size === 0 && moved <= TREMBLE) clicked(event.offsetX, event.offsetY);
    };
    element.addEventListener('pointerup', release);
    element.addEventListener('pointercancel', release);
    element.addEventListener('contextmenu', (event) => event.preventDefault());
    element.addEventListener('wheel', (event) => {
        event.preventDefault();
        orbit.zoom(Math.exp(Math.max(-1, Math.min(1, event.deltaY * 0.0015))));
        changed();
    }, { passive: false });
}
