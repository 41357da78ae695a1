/** The view in 3D: WebGL 2 without a library, because the page must not load any. */
import type { SpaceJson } from "../pictures/space.js";

const vertexShader = `#version 300 es
in vec3 place; in vec3 colour;
uniform mat4 clipFromSpace; uniform float size;
out vec3 position; out vec3 shade;
void main() { gl_Position = clipFromSpace * vec4(place, 1.0); gl_PointSize = size; position = place; shade = colour; }`;

const fragmentShader = `#version 300 es
precision highp float;
in vec3 position; in vec3 shade;
uniform bool isMesh; uniform vec3 toViewer;
out vec4 result;
void main() {
  if (!isMesh) { result = vec4(shade, 1.0); return; }
  vec3 normal = normalize(cross(dFdx(position), dFdy(position)));
  result = vec4(vec3(0.94, 0.54, 0.14) * (0.35 + 0.65 * abs(dot(normal, toViewer))), 1.0);
}`;

/** Distance of the viewer, in sizes of the object, and steps of the coordinates per size; see `spaceOf`. */
const [FRAMED, STEPS_OF_SIZE] = [2.3, 12_800];
/** Radians per pixel of a drag, and per key. */
const [DRAG, KEY] = [0.008, 0.12];

/** A canvas with the mesh and the points of a case. */
export class SpaceView {
  readonly #program: WebGLProgram;
  readonly #distance: number;
  readonly #triangles: number;
  readonly #points: number;
  readonly #arrays: readonly [mesh: WebGLVertexArrayObject, points: WebGLVertexArrayObject];
  #turn = 0;
  #tilt = 0;
  #zoom = 1;

  /** A view; `undefined` where the browser has no WebGL 2. */
  static of(canvas: HTMLCanvasElement, space: SpaceJson): SpaceView | undefined {
    const gl = canvas.getContext("webgl2", { antialias: true, preserveDrawingBuffer: true });
    return gl === null ? undefined : new SpaceView(canvas, gl, space);
  }

  private constructor(
    private readonly canvas: HTMLCanvasElement,
    private readonly gl: WebGL2RenderingContext,
    space: SpaceJson,
  ) {
    this.#distance = FRAMED * STEPS_OF_SIZE * space.stepM;
    this.#program = program(gl);
    const metres = (text: string) => Float32Array.from(new Int16Array(bytes(text).buffer), (x) => x * space.stepM);
    const triangles = new Uint16Array(bytes(space.triangles).buffer);
    const colours = bytes(space.colours);
    this.#triangles = triangles.length;
    this.#points = colours.length / 3;
    this.#arrays = [
      this.#array(metres(space.vertices), null, triangles),
      this.#array(metres(space.points), colours, null),
    ];
    gl.enable(gl.DEPTH_TEST);
    gl.clearColor(0.97, 0.97, 0.98, 1);
    this.#listen();
    this.#draw();
  }

  /** Frees the graphics memory at once: browsers allow few contexts. */
  dispose(): void {
    this.gl.getExtension("WEBGL_lose_context")?.loseContext();
  }

  #array(places: Float32Array, colours: Uint8Array | null, indices: Uint16Array | null): WebGLVertexArrayObject {
    const gl = this.gl;
    const array = gl.createVertexArray();
    gl.bindVertexArray(array);
    const attribute = (name: string, data: Float32Array | Uint8Array) => {
      const at = gl.getAttribLocation(this.#program, name);
      gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
      gl.bufferData(gl.ARRAY_BUFFER, data as Float32Array<ArrayBuffer>, gl.STATIC_DRAW);
      gl.enableVertexAttribArray(at);
      gl.vertexAttribPointer(at, 3, data instanceof Uint8Array ? gl.UNSIGNED_BYTE : gl.FLOAT, true, 0, 0);
    };
    attribute("place", places);
    if (colours !== null) attribute("colour", colours);
    if (indices !== null) {
      gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
      gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, indices as Uint16Array<ArrayBuffer>, gl.STATIC_DRAW);
    }
    return array;
  }

  #listen(): void {
    const canvas = this.canvas;
    const change = (turn: number, tilt: number, zoom = 1) => {
      this.#turn += turn;
      this.#tilt = Math.min(Math.max(this.#tilt + tilt, -1.5), 1.5);
      this.#zoom = Math.min(Math.max(this.#zoom * zoom, 0.2), 5);
      this.#draw();
    };
    canvas.addEventListener("pointerdown", (event) => canvas.setPointerCapture(event.pointerId));
    canvas.addEventListener("pointermove", (event) => {
      if (canvas.hasPointerCapture(event.pointerId)) change(event.movementX * DRAG, event.movementY * DRAG);
    });
    canvas.addEventListener(
      "wheel",
      (event) => {
        event.preventDefault();
        change(0, 0, Math.exp(event.deltaY * 0.001));
      },
      { passive: false },
    );
    canvas.addEventListener("keydown", (event) => {
      const moves: Record<string, [number, number, number?]> = {
        ...{ ArrowLeft: [-KEY, 0], ArrowRight: [KEY, 0], ArrowUp: [0, -KEY], ArrowDown: [0, KEY] },
        ...{ "+": [0, 0, 0.9], "-": [0, 0, 1.1] },
      };
      const move = moves[event.key];
      if (move === undefined) return;
      event.preventDefault();
      change(...move);
    });
  }

  #draw(): void {
    const gl = this.gl;
    const { width, height } = this.canvas;
    const [s, c, a, b] = [Math.sin(this.#turn), Math.cos(this.#turn), Math.sin(this.#tilt), Math.cos(this.#tilt)];
    // Turned about y of the camera, which points down, then tilted about x.
    const rows = [
      [c, 0, -s],
      [s * a, b, c * a],
      [s * b, -a, c * b],
    ] as const;
    const away = this.#distance * this.#zoom;
    const [near, far] = [away / 50, away * 10];
    // The camera of OpenCV looks along z, with y down; the field of view is 35 degrees.
    const focal = 1 / Math.tan(0.5 * 0.61);
    const [fx, fy] = [(focal * height) / width, -focal];
    const [depth, shift] = [(far + near) / (far - near), (-2 * far * near) / (far - near)];
    const column = (j: 0 | 1 | 2) => [fx * rows[0][j], fy * rows[1][j], depth * rows[2][j], rows[2][j]];
    const matrix = [...column(0), ...column(1), ...column(2), 0, 0, depth * away + shift, away];
    gl.viewport(0, 0, width, height);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.useProgram(this.#program);
    const uniform = (name: string) => gl.getUniformLocation(this.#program, name);
    gl.uniformMatrix4fv(uniform("clipFromSpace"), false, matrix);
    gl.uniform3f(uniform("toViewer"), rows[2][0], rows[2][1], rows[2][2]);
    gl.uniform1f(uniform("size"), 2);
    gl.uniform1i(uniform("isMesh"), 1);
    gl.bindVertexArray(this.#arrays[0]);
    gl.drawElements(gl.TRIANGLES, this.#triangles, gl.UNSIGNED_SHORT, 0);
    gl.uniform1i(uniform("isMesh"), 0);
    gl.bindVertexArray(this.#arrays[1]);
    gl.drawArrays(gl.POINTS, 0, this.#points);
  }
}

function program(gl: WebGL2RenderingContext): WebGLProgram {
  const made = gl.createProgram();
  for (const [kind, source] of [
    [gl.VERTEX_SHADER, vertexShader],
    [gl.FRAGMENT_SHADER, fragmentShader],
  ] as const) {
    const shader = gl.createShader(kind) as WebGLShader;
    gl.shaderSource(shader, source);
    gl.compileShader(shader);
    gl.attachShader(made, shader);
  }
  gl.linkProgram(made);
  return made;
}

const bytes = (base64: string) => Uint8Array.from(atob(base64), (character) => character.charCodeAt(0));
