// Draws the model and the dense mesh by WebGL 2, lines and cameras over them, and finds what lies under a pixel.
'use strict';

const SURFACE_VERTEX = `#version 300 es
in vec3 position; in vec2 uv; in vec3 tint; in float filled;
uniform mat4 clip_from_model;
out vec3 at; out vec2 texel; out vec3 color; out float is_filled; out vec3 weights;
void main() {
    at = position; texel = uv; color = tint; is_filled = filled;
    int corner = gl_VertexID % 3;
    weights = vec3(corner == 0, corner == 1, corner == 2);
    gl_Position = clip_from_model * vec4(position, 1.0);
}`;

const SURFACE_FRAGMENT = `#version 300 es
precision highp float;
in vec3 at; in vec2 texel; in vec3 color; in float is_filled; in vec3 weights;
uniform int paint; // 0 texture, 1 tint, 2 tint in the light, 3 where colours come from, 4 plain
uniform sampler2D page; uniform sampler2D source; uniform vec3 eye; uniform float wire;
uniform vec3 source_color[5];
out vec4 pixel;
float light() {
    vec3 normal = normalize(cross(dFdx(at), dFdy(at)));
    return 0.5 + 0.5 * abs(dot(normal, normalize(eye - at)));
}
void main() {
    vec3 c = paint == 0 ? texture(page, texel).rgb : color;
    if (paint == 2) c = color * light();
    if (paint == 3) {
        int s = int(texture(source, texel).r * 255.0 + 0.5);
        c = source_color[clamp(is_filled > 0.5 ? 4 : s, 0, 4)] * light();
    }
    if (paint == 4) c = vec3(0.85) * light();
    vec3 pixels = weights / fwidth(weights);
    float edge = 1.0 - smoothstep(0.6, 1.4, min(pixels.x, min(pixels.y, pixels.z)));
    pixel = vec4(mix(c, vec3(0.05, 0.08, 0.12), wire * edge), 1.0);
}`;

// A segment becomes a strip of `width` pixels, a little in front of the surface it lies on.
const LINE_VERTEX = `#version 300 es
in vec3 from; in vec3 to;
uniform mat4 clip_from_model; uniform vec2 viewport; uniform float width; uniform float lift;
void main() {
    vec4 a = clip_from_model * vec4(from, 1.0), b = clip_from_model * vec4(to, 1.0);
    const float near = 0.01;
    if (a.w < near && b.w > near) a = mix(a, b, (near - a.w) / (b.w - a.w));
    else if (b.w < near && a.w > near) b = mix(b, a, (near - b.w) / (a.w - b.w));
    vec2 along = (b.xy / b.w - a.xy / a.w) * viewport;
    vec2 across = normalize(vec2(-along.y, along.x) + vec2(1e-9)) * width / viewport;
    vec4 end = gl_VertexID < 2 ? a : b;
    gl_Position = end + vec4((gl_VertexID % 2 == 0 ? across : -across) * end.w, -lift * end.w, 0.0);
}`;

const LINE_FRAGMENT = `#version 300 es
precision mediump float;
uniform vec3 color; out vec4 pixel;
void main() { pixel = vec4(color, 1.0); }`;

function link_program(gl, vertex, fragment, attributes) {
    const program = gl.createProgram();
    for (const [type, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
        const shader = gl.createShader(type);
        gl.shaderSource(shader, text);
        gl.compileShader(shader);
        if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
        gl.attachShader(program, shader);
    }
    attributes.forEach((name, index) => gl.bindAttribLocation(program, index, name));
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
    const uniform = {};
    for (let i = 0; i < gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS); ++i) {
        const name = gl.getActiveUniform(program, i).name;
        uniform[name.replace('[0]', '')] = gl.getUniformLocation(program, name);
    }
    return { program, uniform };
}

// An attribute from a typed array; bytes become 0..1. `divisor` 1: a value for every segment instead of every vertex.
function attach(gl, index, values, size, { divisor = 0, stride = 0, offset = 0, buffer = null } = {}) {
    const bound = buffer || gl.createBuffer();
    gl.bindBuffer(gl.ARRAY_BUFFER, bound);
    if (!buffer) gl.bufferData(gl.ARRAY_BUFFER, values, gl.STATIC_DRAW);
    const is_byte = values instanceof Uint8Array;
    gl.enableVertexAttribArray(index);
    gl.vertexAttribPointer(index, size, is_byte ? gl.UNSIGNED_BYTE : gl.FLOAT, is_byte, stride, offset);
    gl.vertexAttribDivisor(index, divisor);
    return bound;
}

// A surface: three corners for every face, so that each face has its own colours and edges.
// {position (9 a face), uv (6 a face), tint (9 a face, bytes), filled (3 a face, bytes), ranges: [{page, first, count}]}
class Surface {
    constructor(gl, corners) {
        this.position = corners.position;
        this.ranges = corners.ranges;
        this.array = gl.createVertexArray();
        gl.bindVertexArray(this.array);
        attach(gl, 0, corners.position, 3);
        if (corners.uv) attach(gl, 1, corners.uv, 2);
        attach(gl, 2, corners.tint, 3);
        if (corners.filled) attach(gl, 3, corners.filled, 1);
    }

    // The nearest point of the surface on a ray, or null (Moeller and Trumbore 1997). `front`: only faces that are drawn.
    pick(eye, ray, front) {
        const p = this.position;
        let nearest = Infinity, face = -1;
        for (let i = 0; i < p.length; i += 9) {
            const e1x = p[i + 3] - p[i], e1y = p[i + 4] - p[i + 1], e1z = p[i + 5] - p[i + 2];
            const e2x = p[i + 6] - p[i], e2y = p[i + 7] - p[i + 1], e2z = p[i + 8] - p[i + 2];
            const hx = ray[1] * e2z - ray[2] * e2y, hy = ray[2] * e2x - ray[0] * e2z, hz = ray[0] * e2y - ray[1] * e2x;
            const det = e1x * hx + e1y * hy + e1z * hz;
            if (front ? det <= 1e-12 : Math.abs(det) <= 1e-12) continue;
            const sx = eye[0] - p[i], sy = eye[1] - p[i + 1], sz = eye[2] - p[i + 2];
            const u = (sx * hx + sy * hy + sz * hz) / det;
            if (u < 0 || u > 1) continue;
            const qx = sy * e1z - sz * e1y, qy = sz * e1x - sx * e1z, qz = sx * e1y - sy * e1x;
            const v = (ray[0] * qx + ray[1] * qy + ray[2] * qz) / det;
            if (v < 0 || u + v > 1) continue;
            const t = (e2x * qx + e2y * qy + e2z * qz) / det;
            if (t > 0 && t < nearest) [nearest, face] = [t, i / 9];
        }
        return face < 0 ? null : { point: add(eye, scale(ray, nearest)), face };
    }
}

// Segments, six numbers each.
class Segments {
    constructor(gl, ends, color, width, lift) {
        Object.assign(this, { color, width, lift, count: ends.length / 6 });
        this.array = gl.createVertexArray();
        gl.bindVertexArray(this.array);
        const buffer = attach(gl, 0, ends, 3, { divisor: 1, stride: 24 });
        attach(gl, 1, ends, 3, { divisor: 1, stride: 24, offset: 12, buffer });
    }
}

class Viewer {
    // The scene is {bounds, background, source_colors}; what there is to see is added afterwards.
    constructor(canvas, scene) {
        this.canvas = canvas;
        this.scene = scene;
        this.gl = canvas.getContext('webgl2', { antialias: true, alpha: false });
        if (!this.gl) throw new Error('this browser or machine has no WebGL 2');
        this.orbit = new Orbit(scene.bounds);
        this.surface_program = link_program(this.gl, SURFACE_VERTEX, SURFACE_FRAGMENT, ['position', 'uv', 'tint', 'filled']);
        this.line_program = link_program(this.gl, LINE_VERTEX, LINE_FRAGMENT, ['from', 'to']);
        this.pages = [];
        this.layers = {};   // name -> [Segments]
        this.visible = {};  // name -> is the layer shown?
        // split: part of the width, from the left, that shows the dense mesh instead of the model.
        this.show = { split: 0, paint: 'texture', wire: false, walls: false };
        this.after_draw = () => {};
        new ResizeObserver(() => this.request()).observe(canvas);
    }

    add_segments(layer, ends, color, width, lift = 0.0006) {
        (this.layers[layer] ||= []).push(new Segments(this.gl, ends, color, width, lift));
    }

    // A texture for an atlas page; `image` is an ImageBitmap.
    texture(image, is_color) {
        const gl = this.gl, texture = gl.createTexture();
        gl.bindTexture(gl.TEXTURE_2D, texture);
        gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
        gl.pixelStorei(gl.UNPACK_COLORSPACE_CONVERSION_WEBGL, gl.NONE);
        gl.texImage2D(gl.TEXTURE_2D, 0, is_color ? gl.RGBA8 : gl.R8, is_color ? gl.RGBA : gl.RED, gl.UNSIGNED_BYTE, image);
        gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE);
        gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE);
        gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, is_color ? gl.LINEAR : gl.NEAREST);
        gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, is_color ? gl.LINEAR_MIPMAP_LINEAR : gl.NEAREST);
        if (is_color) {
            gl.generateMipmap(gl.TEXTURE_2D);
            const oblique = gl.getExtension('EXT_texture_filter_anisotropic');
            if (oblique) gl.texParameterf(gl.TEXTURE_2D, oblique.TEXTURE_MAX_ANISOTROPY_EXT, 8);
        }
        return texture;
    }

    request() {
        if (this.pending) return;
        this.pending = true;
        requestAnimationFrame(() => this.draw());
    }

    draw() {
        this.pending = false;
        const gl = this.gl, density = Math.min(window.devicePixelRatio || 1, 2);
        const width = Math.max(1, Math.round(this.canvas.clientWidth * density));
        const height = Math.max(1, Math.round(this.canvas.clientHeight * density));
        if (this.canvas.width !== width || this.canvas.height !== height) Object.assign(this.canvas, { width, height });
        gl.viewport(0, 0, width, height);
        gl.clearColor(...this.scene.background, 1);
        gl.enable(gl.DEPTH_TEST);
        gl.disable(gl.SCISSOR_TEST);
        gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
        this.clip_from_model = this.orbit.clip_from_model(width / height);
        const border = Math.round(width * this.show.split);
        gl.enable(gl.SCISSOR_TEST);
        gl.scissor(0, 0, border, height);
        if (border > 0 && this.dense) this.draw_surface(this.dense, this.show.paint === 'texture' ? 'tint' : 'plain');
        gl.scissor(border, 0, width - border, height);
        if (border < width && this.model) this.draw_surface(this.model, this.show.paint);
        gl.disable(gl.SCISSOR_TEST);
        for (const name of Object.keys(this.layers)) if (this.visible[name]) this.layers[name].forEach((s) => this.draw_segments(s, width, height, density));
        this.after_draw();
    }

    draw_surface(surface, paint) {
        const gl = this.gl, { program, uniform } = this.surface_program;
        gl.useProgram(program);
        // Without their backs, the near walls and the ceiling do not hide the room.
        gl[this.show.walls ? 'disable' : 'enable'](gl.CULL_FACE);
        const paints = { texture: 0, tint: 1, planes: 2, source: 3, plain: 4 };
        gl.uniform1i(uniform.paint, this.pages.length || paint === 'tint' || paint === 'plain' ? paints[paint] : 2);
        gl.uniformMatrix4fv(uniform.clip_from_model, false, this.clip_from_model);
        gl.uniform3fv(uniform.eye, this.orbit.eye());
        gl.uniform1f(uniform.wire, this.show.wire ? 0.75 : 0);
        gl.uniform3fv(uniform.source_color, this.scene.source_colors.flat());
        gl.uniform1i(uniform.page, 0);
        gl.uniform1i(uniform.source, 1);
        gl.bindVertexArray(surface.array);
        for (const { page, first, count } of surface.ranges) {
            if (this.pages[page]) {
                gl.activeTexture(gl.TEXTURE0);
                gl.bindTexture(gl.TEXTURE_2D, this.pages[page].color);
                gl.activeTexture(gl.TEXTURE1);
                gl.bindTexture(gl.TEXTURE_2D, this.pages[page].source);
            }
            gl.drawArrays(gl.TRIANGLES, first, count);
        }
        gl.disable(gl.CULL_FACE);
    }

    draw_segments(segments, width, height, density) {
        const gl = this.gl, { program, uniform } = this.line_program;
        gl.useProgram(program);
        gl.uniformMatrix4fv(uniform.clip_from_model, false, this.clip_from_model);
        gl.uniform2f(uniform.viewport, width, height);
        gl.uniform1f(uniform.width, segments.width * density);
        gl.uniform1f(uniform.lift, segments.lift);
        gl.uniform3fv(uniform.color, segments.color);
        gl.bindVertexArray(segments.array);
        gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, segments.count);
    }

    // Where a point is on the canvas [px from its corner], or null behind the camera.
    project(point) {
        const [x, y, , w] = transform(this.clip_from_model, point);
        if (w <= 0) return null;
        return [((x / w + 1) / 2) * this.canvas.clientWidth, ((1 - y / w) / 2) * this.canvas.clientHeight];
    }

    // What is under a place of the canvas [px]: {point, face, on_model}, or null.
    pick(x, y) {
        const { clientWidth: width, clientHeight: height } = this.canvas;
        const on_model = x >= width * this.show.split;
        const surface = on_model ? this.model : this.dense;
        const ray = this.orbit.ray((2 * x) / width - 1, 1 - (2 * y) / height, width / height);
        const hit = surface && surface.pick(this.orbit.eye(), ray, !this.show.walls);
        return hit ? { ...hit, on_model } : null;
    }
}
