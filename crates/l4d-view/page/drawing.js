// Blends Gaussians with WebGL 2: a quad each, far ones first, into a picture of 16-bit floats where there are some.

const QUAD_VERTEX = `#version 300 es
uniform vec2 size;
layout(location = 0) in vec4 box;    // centre and half size, pixels
layout(location = 1) in vec4 shape;  // shear, yy / determinant, 1 / yy, opacity
layout(location = 2) in vec4 look;   // colour, depth
flat out vec2 centre;
flat out vec4 form;
flat out vec4 paint;
void main() {
  vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2.0 - 1.0;
  vec2 place = box.xy + corner * (box.zw + 1.0);
  gl_Position = vec4(place / size * vec2(2.0, -2.0) + vec2(-1.0, 1.0), 0.0, 1.0);
  centre = box.xy;
  form = shape;
  paint = look;
}`;
const QUAD_FRAGMENT = `#version 300 es
precision highp float;
uniform float height;
uniform bool depth;
flat in vec2 centre;
flat in vec4 form;
flat in vec4 paint;
out vec4 colour;
void main() {
  vec2 d = centre - vec2(gl_FragCoord.x, height - gl_FragCoord.y);
  float along = d.x - form.x * d.y;
  float alpha = min(form.w * exp(-0.5 * (along * along * form.y + d.y * d.y * form.z)), 0.99);
  if (alpha < 1.0 / 255.0) discard;
  colour = vec4((depth ? vec3(1.0 / paint.w) : paint.rgb) * alpha, alpha);
}`;
const SCREEN_VERTEX = `#version 300 es
void main() {
  gl_Position = vec4(vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0, 0.0, 1.0);
}`;
const SCREEN_FRAGMENT = `#version 300 es
precision highp float;
uniform sampler2D blended;
uniform vec3 background;
uniform bool depth;
uniform vec2 range;
uniform vec3 ramp[5];
out vec4 colour;
void main() {
  vec4 found = texelFetch(blended, ivec2(gl_FragCoord.xy), 0);
  vec3 shown = found.rgb + (1.0 - found.a) * background;
  if (depth) {
    float place = clamp(log(found.a / max(found.r, 1e-6) / range.x) / log(range.y / range.x), 0.0, 1.0) * 4.0;
    int left = min(int(place), 3);
    shown = mix(vec3(0.063, 0.063, 0.078), mix(ramp[left], ramp[left + 1], place - float(left)), found.a);
  }
  colour = vec4(clamp(shown, 0.0, 1.0), 1.0);
}`;
/** Colours of depth, near to far; src/pictures.rs has the same list. */
const RAMP = [[253, 231, 37], [94, 201, 98], [33, 145, 140], [59, 82, 139], [68, 1, 84]];

class Drawing {
  constructor(canvas) {
    this.canvas = canvas;
    const gl = canvas.getContext("webgl2", { antialias: false, alpha: false, preserveDrawingBuffer: true });
    this.gl = gl;
    const hasFloats = gl.getExtension("EXT_color_buffer_float") || gl.getExtension("EXT_color_buffer_half_float");
    this.format = hasFloats ? gl.RGBA16F : gl.RGBA8;
    this.quads = this.program(QUAD_VERTEX, QUAD_FRAGMENT, ["size", "height", "depth"]);
    this.screen = this.program(SCREEN_VERTEX, SCREEN_FRAGMENT, ["blended", "background", "depth", "range", "ramp"]);
    this.empty = gl.createVertexArray();
    this.list = gl.createVertexArray();
    this.buffer = gl.createBuffer();
    gl.bindVertexArray(this.list);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.buffer);
    for (let place = 0; place < 3; place++) {
      gl.enableVertexAttribArray(place);
      gl.vertexAttribPointer(place, 4, gl.FLOAT, false, SEEN * 4, place * 16);
      gl.vertexAttribDivisor(place, 1);
    }
    this.target = gl.createFramebuffer();
    this.size = [0, 0];
  }

  program(vertex, fragment, names) {
    const { gl } = this;
    const program = gl.createProgram();
    for (const [kind, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      gl.attachShader(program, shader);
    }
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
    return { program, at: Object.fromEntries(names.map((name) => [name, gl.getUniformLocation(program, name)])) };
  }

  resize(size) {
    if (size[0] === this.size[0] && size[1] === this.size[1]) return;
    const { gl } = this;
    this.size = [...size];
    [this.canvas.width, this.canvas.height] = size;
    gl.deleteTexture(this.texture);
    this.texture = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, this.texture);
    gl.texStorage2D(gl.TEXTURE_2D, 1, this.format, ...size);
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.target);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, this.texture, 0);
  }

  /** Draws Gaussians from a view; `depthRange` makes it a picture of depth. */
  draw(gaussians, view, { background, near, depthRange }) {
    const { gl, quads, screen } = this;
    this.resize([view.width, view.height]);
    const found = gaussians.project(view, near);
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.target);
    gl.viewport(0, 0, view.width, view.height);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    gl.useProgram(quads.program);
    gl.uniform2f(quads.at.size, view.width, view.height);
    gl.uniform1f(quads.at.height, view.height);
    gl.uniform1i(quads.at.depth, depthRange ? 1 : 0);
    gl.bindVertexArray(this.list);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.buffer);
    gl.bufferData(gl.ARRAY_BUFFER, gaussians.ordered.subarray(0, found * SEEN), gl.STREAM_DRAW);
    if (found) gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, found);

    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.disable(gl.BLEND);
    gl.useProgram(screen.program);
    gl.bindTexture(gl.TEXTURE_2D, this.texture);
    gl.uniform1i(screen.at.blended, 0);
    gl.uniform3fv(screen.at.background, background);
    gl.uniform1i(screen.at.depth, depthRange ? 1 : 0);
    gl.uniform2fv(screen.at.range, depthRange ?? [1, 2]);
    gl.uniform3fv(screen.at.ramp, RAMP.flat().map((byte) => byte / 255));
    gl.bindVertexArray(this.empty);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
  }
}
