// Fills the page from the data that the report carries, and joins its controls to the viewer.
'use strict';

const report = JSON.parse(document.getElementById('report-data').textContent);
const by_id = (id) => document.getElementById(id);

// Palette of texel sources, in the order of TexelSource: empty, photograph, dense mesh, filled; then faces that close holes.
const SOURCE_NAMES = ['no colour', 'photographs', 'dense mesh', 'filled in from around', 'closed holes'];
const SOURCE_COLORS = ['#8a8f94', '#d9c7a3', '#6fa3c7', '#e07a3f', '#c23b5a'];
const color_numbers = (hex) => [1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16) / 255);

function bytes_of(id) {
    const text = atob(by_id(id).textContent), bytes = new Uint8Array(text.length);
    for (let i = 0; i < text.length; ++i) bytes[i] = text.charCodeAt(i);
    return bytes;
}

// A typed array that the report carries, or null.
function array_of(name) {
    const element = by_id(`array-${name}`);
    if (!element) return null;
    const Type = { f32: Float32Array, u32: Uint32Array, u16: Uint16Array, u8: Uint8Array }[element.dataset.type];
    return new Type(bytes_of(element.id).buffer);
}

// The model's faces with corners of their own, those of one atlas page side by side.
function model_corners() {
    const position = array_of('model-position'), face = array_of('model-face'), plane = array_of('model-face-plane');
    const uv = array_of('model-uv'), corner_uv = array_of('model-corner-uv'), page = array_of('model-face-page'), filled = array_of('model-face-filled');
    const faces = face.length / 3, page_of = (f) => (page ? page[f] : 0);
    const order = Uint32Array.from({ length: faces }, (_, f) => f).sort((a, b) => page_of(a) - page_of(b) || a - b);
    const corners = {
        position: new Float32Array(9 * faces), uv: uv && new Float32Array(6 * faces), tint: new Uint8Array(9 * faces).fill(200),
        filled: filled && new Float32Array(3 * faces), plane: new Uint32Array(faces), ranges: [],
    };
    order.forEach((f, i) => {
        if (plane) corners.plane[i] = plane[f];
        for (let k = 0; k < 3; ++k) {
            const v = face[3 * f + k];
            corners.position.set(position.subarray(3 * v, 3 * v + 3), 9 * i + 3 * k);
            if (uv) corners.uv.set(uv.subarray(2 * corner_uv[3 * f + k], 2 * corner_uv[3 * f + k] + 2), 6 * i + 2 * k);
            if (plane) corners.tint.set(report.planes.color[plane[f]], 9 * i + 3 * k);
            if (filled) corners.filled[3 * i + k] = filled[f];
        }
        const last = corners.ranges[corners.ranges.length - 1];
        if (last && last.page === page_of(f)) last.count += 3;
        else corners.ranges.push({ page: page_of(f), first: 3 * i, count: 3 });
    });
    return corners;
}

function dense_corners() {
    const face = array_of('dense-face'), position = array_of('dense-position'), color = array_of('dense-color');
    const { min, step } = report.dense;
    const corners = { position: new Float32Array(3 * face.length), tint: new Uint8Array(3 * face.length).fill(170), ranges: [{ page: 0, first: 0, count: face.length }] };
    face.forEach((v, i) => {
        for (let c = 0; c < 3; ++c) {
            corners.position[3 * i + c] = min[c] + step * position[3 * v + c];
            if (color) corners.tint[3 * i + c] = color[3 * v + c];
        }
    });
    return corners;
}

async function load_pages(viewer) {
    const most = viewer.gl.getParameter(viewer.gl.MAX_TEXTURE_SIZE);
    const decode = async (id, mime) => {
        const image = await createImageBitmap(new Blob([bytes_of(id)], { type: mime }), { colorSpaceConversion: 'none', premultiplyAlpha: 'none' });
        if (image.width <= most && image.height <= most) return image;
        return createImageBitmap(image, { resizeWidth: Math.min(image.width, most), resizeHeight: Math.min(image.height, most) });
    };
    for (const [i, page] of (report.pages || []).entries()) {
        const color = viewer.texture(await decode(`page-${i}-color`, page.mime), true);
        viewer.pages.push({ color, source: viewer.texture(await decode(`page-${i}-source`, 'image/png'), false) });
    }
}

// A camera as a small pyramid: {position, right, down, forward}.
function frustum(camera, size) {
    const { fx, fy, width, height } = report.camera;
    const tip = camera.position, x = (size * width) / (2 * fx), y = (size * height) / (2 * fy);
    const at = (sx, sy) => add(tip, add(scale(camera.forward, size), add(scale(camera.right, sx * x), scale(camera.down, sy * y))));
    const corner = [at(-1, -1), at(1, -1), at(1, 1), at(-1, 1)];
    return corner.flatMap((c, i) => [...tip, ...c, ...c, ...corner[(i + 1) % 4]]);
}

const path_of = (points) => points.slice(1).flatMap((p, i) => [...points[i], ...p]);

function add_layers(viewer) {
    const lines = array_of('lines');
    if (lines && lines.length) viewer.add_segments('lines', lines, [1.0, 0.42, 0.1], 2.5);
    if (!report.cameras || !report.cameras.length) return;
    const points = report.cameras.map((c) => c.position), before = report.cameras.map((c) => c.before).filter(Boolean);
    if (before.length) viewer.add_segments('cameras', new Float32Array(path_of(before)), [0.55, 0.55, 0.6], 1.5, 0);
    viewer.add_segments('cameras', new Float32Array(report.cameras.flatMap((c) => frustum(c, 0.1))), [0.2, 0.55, 0.8], 1, 0);
    viewer.add_segments('cameras', new Float32Array(path_of(points)), [0.1, 0.35, 0.75], 3, 0);
}

function stand_at(viewer, camera) {
    viewer.orbit.stand(camera.position, camera.forward);
    viewer.request();
}

// Radio buttons, check boxes and buttons of the toolbar; what the report does not hold is disabled.
function join_controls(viewer, measurement) {
    const inputs = [...document.querySelectorAll('.toolbar input')];
    const disable = (name, value, is_missing) => inputs.filter((i) => i.name === name && (!value || i.value === value)).forEach((i) => (i.disabled = is_missing));
    ['dense', 'split'].forEach((side) => disable('side', side, !viewer.dense));
    ['texture', 'source'].forEach((paint) => disable('paint', paint, !viewer.pages.length));
    disable('lines', '', !viewer.layers.lines);
    disable('cameras', '', !viewer.layers.cameras);
    const apply = () => {
        const chosen = Object.fromEntries(inputs.filter((i) => i.checked).map((i) => [i.name, i.value]));
        viewer.show.split = { model: 0, dense: 1, split: 0.5 }[chosen.side];
        viewer.show.paint = chosen.paint;
        viewer.show.wire = 'wire' in chosen;
        viewer.show.walls = 'walls' in chosen;
        viewer.visible = { lines: 'lines' in chosen, cameras: 'cameras' in chosen };
        by_id('divider').hidden = chosen.side !== 'split';
        by_id('divider').style.left = '50%';
        by_id('source-legend').hidden = chosen.paint !== 'source';
        viewer.request();
    };
    inputs.forEach((input) => input.addEventListener('change', apply));
    by_id('home').addEventListener('click', () => { viewer.orbit.home(); viewer.request(); });
    by_id('clear').addEventListener('click', () => measurement.clear());
    const cameras = report.cameras || [];
    by_id('inside').disabled = !cameras.length;
    by_id('inside').addEventListener('click', () => stand_at(viewer, cameras[Math.floor(cameras.length / 2)]));
    by_id('source-legend').innerHTML = SOURCE_NAMES.map((name, i) => `<li><i style="background:${SOURCE_COLORS[i]}"></i>${name}</li>`).slice(1).join('');
    apply();
}

function join_divider(viewer) {
    const divider = by_id('divider');
    divider.addEventListener('pointerdown', (event) => divider.setPointerCapture(event.pointerId));
    divider.addEventListener('pointermove', (event) => {
        if (!divider.hasPointerCapture(event.pointerId)) return;
        const box = viewer.canvas.getBoundingClientRect();
        viewer.show.split = Math.max(0.02, Math.min(0.98, (event.clientX - box.left) / box.width));
        divider.style.left = `${100 * viewer.show.split}%`;
        viewer.request();
    });
}

async function show_model() {
    const background = getComputedStyle(document.documentElement).getPropertyValue('--stage').trim();
    const viewer = new Viewer(by_id('canvas'), { bounds: report.bounds, background: color_numbers(background), source_colors: SOURCE_COLORS.map(color_numbers) });
    const corners = model_corners();
    viewer.model = new Surface(viewer.gl, corners);
    await load_pages(viewer);
    if (report.dense) viewer.dense = new Surface(viewer.gl, dense_corners());
    add_layers(viewer);
    const plane_of = (face) => (report.planes ? report.planes.equation[corners.plane[face]] : null);
    const measurement = new Measurement(viewer, by_id('overlay'), by_id('readout'), plane_of);
    viewer.after_draw = () => measurement.draw();
    follow_pointers(viewer.canvas, viewer.orbit, () => viewer.request(), (x, y) => measurement.click(x, y));
    join_controls(viewer, measurement);
    join_divider(viewer);
    measurement.clear();
    return { viewer, measurement };
}

const seconds_text = (s) => (s >= 100 ? `${Math.floor(s / 60)} min ${Math.round(s % 60)} s` : `${figure_text(Number(s.toPrecision(3)))} s`);
const bytes_text = (b) => (b >= 1e9 ? `${(b / 1e9).toFixed(2)} GB` : `${Math.round(b / 1e6)} MB`);
const metric = (name) => (report.metrics || []).find((m) => m.name === name);

function reveal(id, html) {
    const section = by_id(id);
    section.hidden = false;
    section.querySelector('div').innerHTML = html;
    return section;
}

function show_facts() {
    const s = report.summary, facts = [];
    document.title = by_id('title').textContent = report.scan;
    const parts = [`${s.faces.toLocaleString('en')} faces in ${s.planes.toLocaleString('en')} planes`];
    if (s.dense_faces) parts.push(`from a dense mesh of ${s.dense_faces.toLocaleString('en')}`);
    if (s.frames) parts.push(`scanned in ${s.frames.toLocaleString('en')} frames`);
    by_id('lead').textContent = `${parts.join(', ')}. Pipeline ${report.pipeline}, ${report.generator}.`;
    const add_fact = (value, name) => facts.push(`<div class="fact"><b>${value}</b><span>${name}</span></div>`);
    add_fact(`${[0, 2, 1].map((c) => (report.bounds.max[c] - report.bounds.min[c]).toFixed(2)).join(' × ')} m`, 'length, width and height');
    add_fact(`${s.area.toFixed(1)} m²`, 'surface');
    if (s.dense_faces) add_fact(`${((100 * s.faces) / s.dense_faces).toFixed(1)} %`, 'faces left of the dense mesh');
    const photographed = metric('texture.photograph');
    if (photographed) add_fact(`${(100 * photographed.value).toFixed(1)} %`, 'of the surface coloured by photographs');
    const views = metric('views.model.psnr');
    if (views) add_fact(`${views.value.toFixed(1)} dB`, 'PSNR of views held out');
    if (s.held_out) {
        const kept = s.held_out.is_input_kept ? '; worse, so the poses stay as they were' : '';
        add_fact(`${s.held_out.input.toFixed(1)} → ${s.held_out.optimized.toFixed(1)}`, `grey levels between photographs, by the alignment${kept}`);
    }
    if (report.stages.length) add_fact(seconds_text(report.stages.reduce((sum, t) => sum + t.seconds, 0)), 'to compute');
    if (report.model_file) facts.push(`<div class="fact"><a href="${escape_html(report.model_file)}">${escape_html(report.model_file.split('/').pop())}</a><br><span>for other programs</span></div>`);
    by_id('facts').innerHTML = facts.join('');
}

const GROUPS = {
    size: 'Size', hygiene: 'Cleanness of the mesh', geometry: 'Model against truth or dense mesh', dense: 'Dense mesh', planes: 'Planes', creases: 'Edges',
    poses: 'Camera poses', exposure: 'Exposures', texture: 'Texture', views: 'Held-out photographs',
};

function show_metrics() {
    if (!report.metrics) return;
    const groups = new Map();
    for (const m of report.metrics) {
        const key = m.name.split('.')[0];
        if (!groups.has(key)) groups.set(key, []);
        groups.get(key).push(m);
    }
    const sign = { lower: '↓', higher: '↑', neither: '' }, title = { lower: 'lower is better', higher: 'higher is better', neither: '' };
    const row = (m) => `<tr><td>${escape_html(m.name.split('.').slice(1).join(' ').replaceAll('_', ' '))}</td><td class="number">${figure_text(m.value)} ${escape_html(m.unit)}</td>` +
        `<td class="better" title="${title[m.better]}">${sign[m.better]}</td></tr>`;
    reveal('metrics', [...groups].map(([key, list]) => `<div><h3>${escape_html(GROUPS[key] || key)}</h3><table>${list.map(row).join('')}</table></div>`).join(''));
}

function show_sections() {
    if (metric('texture.photograph')) {
        const names = ['empty', 'photograph', 'dense_mesh', 'filled'];
        const share = (name) => (metric(`texture.${name}`) || { value: 0 }).value;
        const parts = names.map((name, i) => ({ name: SOURCE_NAMES[i], value: share(name), color: SOURCE_COLORS[i] }));
        const closed = report.summary.filled_area;
        reveal('coverage', share_bar([parts[1], parts[2], parts[3], parts[0]]) +
            (closed ? `<p>Holes of ${closed.toFixed(2)} m² were closed; choose “Source” above to see them.</p>` : ''));
    }
    if (report.energy) reveal('energies', report.energy.names.map((name, c) => line_chart(name, report.energy.rows.map((r) => r[c]))).join(''));
    if (report.stages.length) {
        const rows = report.stages.map((s) => ({ name: s.name, values: [s.seconds, s.peak_memory_bytes] }));
        reveal('stages', bar_table(rows, [{ title: 'time', text: seconds_text }, { title: 'peak memory', text: bytes_text }]));
        const list = (params) => Object.entries(params).map(([k, v]) => `<tr><td>${escape_html(k)}</td><td class="number">${escape_html(v)}</td></tr>`).join('');
        reveal('parameters', report.stages.map((s) => `<details><summary>${escape_html(s.name)}</summary><table>${list(s.params)}</table></details>`).join(''));
    }
    if (report.sharpness) {
        const chart = dot_chart('blur of every frame', report.sharpness);
        if (chart) reveal('sharpness', `<p>Blur from 0 (sharp) to 1; <b style="color:var(--accent)">keyframes</b>, <b style="color:var(--cool)">held out</b>, others. Lower is sharper.</p>${chart}`);
    }
}

function show_photographs(viewer) {
    if (!report.photographs || !report.photographs.length) return;
    const picture = (p, i) => `<button type="button" data-camera="${p.camera}"><svg viewBox="0 0 ${p.width} ${p.height}"><image width="${p.width}" height="${p.height}" href="data:image/jpeg;base64,${by_id(`photograph-${i}`).textContent.trim()}"/>` +
        p.segments.map(([x0, y0, x1, y1]) => `<line x1="${x0}" y1="${y0}" x2="${x1}" y2="${y1}"/>`).join('') + `</svg><small>frame ${p.frame}, ${p.segments.length} lines</small></button>`;
    const section = reveal('photographs', report.photographs.map(picture).join(''));
    section.addEventListener('click', (event) => {
        const button = event.target.closest('button');
        if (!button || !viewer) return;
        stand_at(viewer, report.cameras[Number(button.dataset.camera)]);
        by_id('canvas').scrollIntoView({ behavior: 'smooth', block: 'center' });
    });
}

async function main() {
    show_facts();
    show_metrics();
    show_sections();
    try {
        window.quoin = await show_model();
        show_photographs(window.quoin.viewer);
    } catch (error) {
        by_id('readout').textContent = `The model cannot be shown: ${error.message}. Everything else is below.`;
        show_photographs(null);
    }
}

main();
