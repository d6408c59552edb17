// Two meshes side by side with one camera, flat shaded, coloured by a value at each vertex.

const kVertexShader = `#version 300 es
in vec3 position; in float value; uniform mat3 turn; uniform vec2 scale; uniform vec2 shift;
out vec3 place; out float v;
void main() { place = turn * position; v = value; gl_Position = vec4(place.xy * scale + shift, -0.4 * place.z, 1.0); }`;

const kFragmentShader = `#version 300 es
precision highp float;
in vec3 place; in float v; uniform vec3 low, middle, high; out vec4 color;
void main() {
  vec3 normal = normalize(cross(dFdx(place), dFdy(place)));
  float light = 0.25 + 0.75 * abs(dot(normal, normalize(vec3(0.25, 0.35, 1.0))));
  float t = clamp(v, -1.0, 1.0);
  color = vec4(light * (t < 0.0 ? mix(middle, low, -t) : mix(middle, high, t)), 1.0);
}`;

const kPlain = [0.8, 0.77, 0.71];
const kPalettes = {moved: [[0.13, 0.4, 0.67], [0.87, 0.85, 0.82], [0.7, 0.09, 0.17]],
                   values: [[0.87, 0.85, 0.82], [0.87, 0.85, 0.82], [0.75, 0.3, 0.03]]};

function programOf(gl) {
  const program = gl.createProgram();
  for (const [type, text] of [[gl.VERTEX_SHADER, kVertexShader], [gl.FRAGMENT_SHADER, kFragmentShader]]) {
    const shader = gl.createShader(type);
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    gl.attachShader(program, shader);
  }
  gl.linkProgram(program);
  return gl.getProgramParameter(program, gl.LINK_STATUS) ? program : null;
}

const multiplied = (A, B) => A.map((_, i) => [0, 1, 2].reduce((sum, k) => sum + A[(i % 3) + 3 * k] * B[k + 3 * Math.floor(i / 3)], 0));

export class View {
  /** @throws Error  where there is no WebGL 2; numbers work without. */
  constructor(canvas) {
    this.canvas = canvas;
    const gl = this.gl = canvas.getContext('webgl2', {antialias: true, preserveDrawingBuffer: true});
    this.program = gl && programOf(gl);
    if (!this.program) throw new Error('This browser shows no 3D pictures here (WebGL 2); everything else works.');
    gl.enable(gl.DEPTH_TEST);
    this.sides = [0, 1].map(() => ({positions: gl.createBuffer(), values: gl.createBuffer()}));
    this.corners = gl.createBuffer();
    this.count = 0;
    this.turn = [1, 0, 0, 0, 1, 0, 0, 0, 1];
    this.zoom = 1;
    this.shift = [0, 0];
    this.palette = 'moved';
    this.listen();
    new ResizeObserver(() => this.drawSoon()).observe(canvas);
  }

  /** Shows a mesh on both sides, from the front. */
  show(V, F) {
    const {gl} = this, low = [Infinity, Infinity, Infinity], high = low.map((x) => -x);
    for (let i = 0; i < V.length; i++) {
      low[i % 3] = Math.min(low[i % 3], V[i]);
      high[i % 3] = Math.max(high[i % 3], V[i]);
    }
    this.middle = low.map((x, k) => (x + high[k]) / 2);
    this.size = Math.hypot(...low.map((x, k) => high[k] - x)) / 2 || 1;
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, this.corners);
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, F, gl.STATIC_DRAW);
    this.count = F.length;
    this.zoom = 1;
    this.shift = [0, 0];
    this.turn = [0.9, 0.15, -0.41, 0, 0.94, 0.34, 0.44, -0.31, 0.85];
    this.move(V, 0, 1);
    this.color(null);
  }

  move(V, ...sides) {
    const {gl} = this, positions = new Float32Array(V.length);
    for (let i = 0; i < V.length; i++) positions[i] = (V[i] - this.middle[i % 3]) / this.size;
    for (const side of sides) {
      gl.bindBuffer(gl.ARRAY_BUFFER, this.sides[side].positions);
      gl.bufferData(gl.ARRAY_BUFFER, positions, gl.STATIC_DRAW);
    }
    this.drawSoon();
  }

  /** Colours both sides by values from -1 to 1; null: none. */
  color(values, palette = 'moved') {
    const {gl} = this;
    this.palette = values ? palette : null;
    this.values = values;
    for (const {values: buffer} of this.sides) {
      gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
      gl.bufferData(gl.ARRAY_BUFFER, values ?? new Float32Array(0), gl.STATIC_DRAW);
    }
    this.drawSoon();
  }

  /** Draws once for all changes of a frame: large meshes take a processor seconds. */
  drawSoon() {
    this.frame ??= requestAnimationFrame(() => {
      this.frame = null;
      this.draw();
    });
  }

  draw() {
    const {gl, canvas, program} = this, ratio = Math.min(devicePixelRatio, 2);
    canvas.width = Math.max(2, canvas.clientWidth * ratio);
    canvas.height = Math.max(1, canvas.clientHeight * ratio);
    gl.clearColor(0.95, 0.95, 0.94, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    if (this.count === 0) return;
    gl.useProgram(program);
    const width = canvas.width / 2, height = canvas.height, scale = (this.zoom * Math.min(width, height)) * 1.2;
    const at = (name) => gl.getUniformLocation(program, name);
    gl.uniformMatrix3fv(at('turn'), false, this.turn);
    gl.uniform2f(at('scale'), scale / width, scale / height);
    gl.uniform2f(at('shift'), ...this.shift);
    const [low, middle, high] = this.palette ? kPalettes[this.palette] : [kPlain, kPlain, kPlain];
    for (const [name, color] of Object.entries({low, middle, high})) gl.uniform3fv(at(name), color);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, this.corners);
    this.sides.forEach(({positions, values}, side) => {
      gl.viewport(side * width, 0, width, height);
      for (const [name, buffer, size] of [['position', positions, 3], ['value', values, 1]]) {
        const attribute = gl.getAttribLocation(program, name);
        gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
        if (name === 'value' && !this.palette) { gl.disableVertexAttribArray(attribute); continue; }
        gl.enableVertexAttribArray(attribute);
        gl.vertexAttribPointer(attribute, size, gl.FLOAT, false, 0, 0);
      }
      gl.drawElements(gl.TRIANGLES, this.count, gl.UNSIGNED_INT, 0);
    });
  }

  rotate(x, y) {
    const [cx, sx, cy, sy] = [Math.cos(x), Math.sin(x), Math.cos(y), Math.sin(y)];
    this.turn = multiplied([1, 0, 0, 0, cy, sy, 0, -sy, cy], multiplied([cx, 0, -sx, 0, 1, 0, sx, 0, cx], this.turn));
    this.drawSoon();
  }

  pan(x, y) {
    this.shift = [this.shift[0] + x, this.shift[1] + y];
    this.drawSoon();
  }

  enlarge(factor) {
    this.zoom = Math.min(50, Math.max(0.2, this.zoom * factor));
    this.shift = this.shift.map((x) => x * factor);
    this.drawSoon();
  }

  listen() {
    const {canvas} = this, pointers = new Map();
    canvas.addEventListener('pointerdown', (event) => { canvas.setPointerCapture(event.pointerId); pointers.set(event.pointerId, event); });
    for (const name of ['pointerup', 'pointercancel']) canvas.addEventListener(name, (event) => pointers.delete(event.pointerId));
    canvas.addEventListener('pointermove', (event) => {
      const before = pointers.get(event.pointerId);
      if (!before) return;
      const [x, y] = [event.clientX - before.clientX, event.clientY - before.clientY];
      const other = [...pointers.values()].find((one) => one.pointerId !== event.pointerId);
      if (other) {
        const distance = (one) => Math.hypot(one.clientX - other.clientX, one.clientY - other.clientY) || 1;
        this.enlarge(distance(event) / distance(before));
      } else if (event.shiftKey || before.button === 2) {
        this.pan((4 * x) / canvas.clientWidth, (-2 * y) / canvas.clientHeight);
      } else {
        this.rotate(x / 150, y / 150);
      }
      pointers.set(event.pointerId, event);
    });
    canvas.addEventListener('wheel', (event) => { event.preventDefault(); this.enlarge(Math.exp(-event.deltaY / 500)); }, {passive: false});
    canvas.addEventListener('contextmenu', (event) => event.preventDefault());
    const keys = {ArrowLeft: () => this.rotate(-0.1, 0), ArrowRight: () => this.rotate(0.1, 0), ArrowUp: () => this.rotate(0, -0.1),
                  ArrowDown: () => this.rotate(0, 0.1), '+': () => this.enlarge(1.2), '-': () => this.enlarge(1 / 1.2)};
    canvas.addEventListener('keydown', (event) => {
      if (!keys[event.key]) return;
      event.preventDefault();
      keys[event.key]();
    });
  }
}
