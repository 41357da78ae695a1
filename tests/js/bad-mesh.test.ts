/** Bad meshes: a typed error that says what to do. */
import { changed, refusesInputs } from "../support/bad-input.js";
import type { Refusals } from "../support/errors.js";
import { mesh } from "../support/scene.js";

const scaled = (x: number, y: number, z: number) => ({
  ...mesh,
  positions: mesh.positions.map((value, i) => value * ([x, y, z][i % 3] ?? 0)),
});

const meshes: Refusals<object> = {
  "mesh missing: INVALID_ARGUMENT mesh": [{ mesh: undefined }, /found nothing/],
  "positions as a plain array: INVALID_ARGUMENT mesh.positions": [
    { mesh: { positions: [0, 0, 0] } },
    /Float32Array\.from/,
  ],
  "positions as doubles: INVALID_ARGUMENT mesh.positions": [
    { mesh: { positions: new Float64Array(9) } },
    /Float32Array\.from/,
  ],
  "positions not in threes: WRONG_LENGTH mesh.positions": [
    { mesh: { ...mesh, positions: mesh.positions.slice(1) } },
    /multiple of 3/,
  ],
  "indices as a plain array: INVALID_ARGUMENT mesh.indices": [
    { mesh: { ...mesh, indices: [0, 1, 2] } },
    /Uint32Array\.from/,
  ],
  "indices not in threes: WRONG_LENGTH mesh.indices": [
    { mesh: { ...mesh, indices: mesh.indices.slice(1) } },
    /multiple of 3/,
  ],
  "an index out of range: INDEX_OUT_OF_RANGE mesh.indices": [
    { mesh: { ...mesh, indices: changed(mesh.indices, 7, 1e6) } },
    /1000000 in triangle 2/,
  ],
  "no triangle: EMPTY_MESH mesh": [{ mesh: { ...mesh, indices: new Uint32Array(0) } }, /no triangle/],
  "no vertex: EMPTY_MESH mesh": [{ mesh: { positions: new Float32Array(0) } }, /no triangle/],
  "a NaN vertex: NON_FINITE mesh.positions": [
    { mesh: { ...mesh, positions: changed(mesh.positions, 4, Number.NaN) } },
    /NaN.*vertex 1/,
  ],
  "an infinite vertex: NON_FINITE mesh.positions": [
    { mesh: { ...mesh, positions: changed(mesh.positions, 0, Number.POSITIVE_INFINITY) } },
    /Infinity.*vertex 0/,
  ],
  "a mesh without area: DEGENERATE_MESH mesh": [{ mesh: scaled(0, 0, 0) }],
  "a planar mesh: DEGENERATE_MESH mesh": [{ mesh: scaled(1, 1, 0) }],
  "a needle: DEGENERATE_MESH mesh": [{ mesh: scaled(1, 0, 0) }],
};

refusesInputs(meshes);
