/** Bad meshes: a typed error that says what to do. */
import { type Bad, changed, refuses } from "../support/bad-input.js";
import { mesh } from "../support/scene.js";

const scaled = (x: number, y: number, z: number) => ({
  ...mesh,
  positions: mesh.positions.map((value, i) => value * ([x, y, z][i % 3] ?? 0)),
});

const meshes: Bad[] = [
  ["mesh missing", { mesh: undefined }, "INVALID_ARGUMENT", "mesh", /found nothing/],
  [
    "positions as a plain array",
    { mesh: { positions: [0, 0, 0] } },
    "INVALID_ARGUMENT",
    "mesh.positions",
    /Float32Array\.from/,
  ],
  [
    "positions as doubles",
    { mesh: { positions: new Float64Array(9) } },
    "INVALID_ARGUMENT",
    "mesh.positions",
    /Float32Array\.from/,
  ],
  [
    "positions not in threes",
    { mesh: { ...mesh, positions: mesh.positions.slice(1) } },
    "WRONG_LENGTH",
    "mesh.positions",
    /multiple of 3/,
  ],
  [
    "indices as a plain array",
    { mesh: { ...mesh, indices: [0, 1, 2] } },
    "INVALID_ARGUMENT",
    "mesh.indices",
    /Uint32Array\.from/,
  ],
  [
    "indices not in threes",
    { mesh: { ...mesh, indices: mesh.indices.slice(1) } },
    "WRONG_LENGTH",
    "mesh.indices",
    /multiple of 3/,
  ],
  [
    "an index out of range",
    { mesh: { ...mesh, indices: changed(mesh.indices, 7, 1e6) } },
    "INDEX_OUT_OF_RANGE",
    "mesh.indices",
    /1000000 in triangle 2/,
  ],
  ["no triangle", { mesh: { ...mesh, indices: new Uint32Array(0) } }, "EMPTY_MESH", "mesh", /no triangle/],
  ["no vertex", { mesh: { positions: new Float32Array(0) } }, "EMPTY_MESH", "mesh", /no triangle/],
  [
    "a NaN vertex",
    { mesh: { ...mesh, positions: changed(mesh.positions, 4, Number.NaN) } },
    "NON_FINITE",
    "mesh.positions",
    /NaN.*vertex 1/,
  ],
  [
    "an infinite vertex",
    { mesh: { ...mesh, positions: changed(mesh.positions, 0, Number.POSITIVE_INFINITY) } },
    "NON_FINITE",
    "mesh.positions",
    /Infinity.*vertex 0/,
  ],
  ["a mesh without area", { mesh: scaled(0, 0, 0) }, "DEGENERATE_MESH", "mesh", /./],
  ["a planar mesh", { mesh: scaled(1, 1, 0) }, "DEGENERATE_MESH", "mesh", /./],
  ["a needle", { mesh: scaled(1, 0, 0) }, "DEGENERATE_MESH", "mesh", /./],
];

refuses(meshes);
