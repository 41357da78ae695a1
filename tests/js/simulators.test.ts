/** Scenes for simulators: bodies, mass and rest, and the files, which the simulators themselves load. */
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { join } from "node:path";
import { test } from "node:test";
import { toSim3 } from "sim3align/conventions";
import { type SimulatorObject, type SimulatorScene, simulatorScene, toMjcf, toUrdf, toUsd } from "sim3align/simulators";
import { folder, succeeds, writeCase } from "../support/command-line.js";
import { repository } from "../support/environment.js";
import { type Files, writeFiles } from "../support/files.js";
import { assertNear } from "../support/random.js";
import { cuboid, type Mesh } from "../support/scene.js";
import { tableFiles } from "../support/table.js";

/** A box from a corner with these sides. */
function box(x: number, y: number, z: number, at = [0, 0, 0]): Mesh {
  const { positions, indices } = cuboid(x / 2, y / 2, z / 2);
  const corner = [x / 2 + (at[0] ?? 0), y / 2 + (at[1] ?? 0), z / 2 + (at[2] ?? 0)];
  return { positions: positions.map((p, i) => p + (corner[i % 3] ?? 0)), indices };
}

/** A bowl: a box with a hole from above, of five plates. */
function tray(): Mesh {
  const plates = [
    box(0.2, 0.2, 0.02),
    box(0.02, 0.2, 0.08, [0, 0, 0.02]),
    box(0.02, 0.2, 0.08, [0.18, 0, 0.02]),
    box(0.16, 0.02, 0.08, [0.02, 0, 0.02]),
    box(0.16, 0.02, 0.08, [0.02, 0.18, 0.02]),
  ];
  const indices = plates.flatMap((plate, k) => Array.from(plate.indices, (i) => i + 8 * k));
  const positions = plates.flatMap((plate) => Array.from(plate.positions));
  return { positions: Float32Array.from(positions), indices: Uint32Array.from(indices) };
}

/** The ground of a camera that looks down from 1 m: x right, y towards the top of the image, z up. */
const below = { normal: [0, 0, -1] as const, d: 1 };
/** Boxes need no convex parts. */
const hulls = { support: below, maxParts: 1 };
/** OpenCV camera from a mesh with z up, at a place over that ground. */
const over = (x: number, y: number, z: number, tiltDeg = 0) => {
  const [s, c] = [Math.sin((tiltDeg * Math.PI) / 180), Math.cos((tiltDeg * Math.PI) / 180)];
  return toSim3([1, 0, 0, 0, 0, -c, -s, 0, 0, s, -c, 0, x, -y, 1 - z, 1]);
};
const tower = box(0.1, 0.1, 0.2);

test("walls of an open box that parts join are named", async () => {
  const open = { ...tower, indices: tower.indices.slice(6) };
  const joined = async (maxParts?: number) =>
    (await simulatorScene([{ mesh: open, transform: over(0, 0, 0) }], { maxParts })).bodies[0]?.wallsJoined;
  assert.deepEqual([await joined(), await joined(5), await joined(4)], [null, null, 5]);
});

test("a body that leans is put at rest, with its pose before in every file; one that falls or hangs stays, fixed", async () => {
  const objects: SimulatorObject[] = [
    { name: "leans", mesh: tower, transform: over(-0.5, 0, 0.001, 0.5) },
    { name: "falls", mesh: tower, transform: over(0.5, 0, 0, 30) },
    { name: "hangs", mesh: tower, transform: over(0, 0.5, 0.4), restsOn: null },
  ];
  const scene = await simulatorScene(objects, hulls);
  const [leans, falls, hangs] = scene.bodies;
  assert.ok(leans && falls && hangs && !leans.isFixed && falls.isFixed && hangs.isFixed);
  assertNear([leans.turnedDeg, leans.position[2], leans.found.position[2]], [0.5, 0, 0.001], "at rest", 1e-3);
  assert.deepEqual(leans.rest, { moveM: leans.movedM, turnDeg: leans.turnedDeg });
  assert.equal(falls.movedM + falls.turnedDeg + hangs.movedM, 0);
  assert.ok(falls.rest !== null && falls.rest.turnDeg > 12 && hangs.rest === null);
  // The bounds are options, and without a support, everything is fixed.
  const wide = { ...hulls, maxTurnDeg: 3, maxMoveM: 0.02 };
  const turnedBy = async (options: object) =>
    (await simulatorScene([{ mesh: tower, transform: over(0, 0, 0, 2) }], options)).bodies[0]?.turnedDeg ?? -1;
  assertNear([await turnedBy(hulls), await turnedBy(wide)], [0, 2], "bounds", 1e-3);
  assert.ok((await simulatorScene(objects, { maxParts: 1 })).bodies.every(({ isFixed }) => isFixed));
  const { position, rotation } = leans.found;
  assert.notDeepEqual(leans.rotation, rotation);
  const short = (x: number) => String(Number(x.toPrecision(7)));
  const [at, [x, y, z, w]] = [position.map(short), rotation.map(short)];
  const numeric = /<numeric name="leans_found" size="7" data="([^"]*)"/.exec(toMjcf(scene)["scene.xml"] ?? "");
  assert.equal(numeric?.[1], [...at, w, x, y, z].join(" "));
  const resting = /<body name="leans" [^>]*quat="([^"]*)"/.exec(toMjcf(scene)["scene.xml"] ?? "")?.[1];
  const [restX = 0, restY = 0, restZ = 0, restW = 1] = leans.rotation;
  assertNear((resting ?? "").split(" ").map(Number), [restW, restX, restY, restZ], "w comes first in MuJoCo", 1e-6);
  const [, inJson] = JSON.parse(toUrdf(scene)["scene.json"] ?? "").bodies;
  assert.deepEqual(inJson.found, { position, quaternion: rotation });
  assert.ok(toUsd(scene).includes(`custom double3 found:translate = (${at.join(", ")})`));
  assert.ok(toUsd(scene).includes(`custom quatd found:orient = (${[w, x, y, z].join(", ")})`));
  const kept = await simulatorScene(objects.slice(0, 1), { ...hulls, rest: false });
  for (const { found, position, rotation, movedM, isFixed } of kept.bodies) {
    assert.deepEqual([{ position, rotation }, movedM, isFixed], [found, 0, false]);
  }
});

test("what is no scene is an error, and flat or degenerate meshes are none", async () => {
  const one = (positions: number[], ...indices: number[]) => {
    const mesh = { positions: Float32Array.from(positions), indices: Uint32Array.from(indices) };
    return [{ mesh, transform: over(0, 0, 0) }];
  };
  const refused: [objects: unknown, options: object, code: string][] = [
    ["objects", {}, "INVALID_ARGUMENT"],
    [one([0, 0, 0]), {}, "EMPTY_MESH"],
    [[], { density: 0 }, "INVALID_ARGUMENT"],
    [[], { rest: "no" }, "INVALID_ARGUMENT"],
    [[], { maxparts: 4 }, "UNKNOWN_OPTION"],
    [[], { support: { normal: [0, 0, 0], d: 1 } }, "INVALID_ARGUMENT"],
  ];
  for (const [objects, options, code] of refused)
    await assert.rejects(simulatorScene(objects as never, options), { code });
  const flat = one([0, 0, 0, 1, 0, 0, 0, 1, 0], 0, 1, 2);
  const scene = await simulatorScene([...flat, ...one(new Array(9).fill(0), 0, 1, 2)], { support: below });
  assert.ok((scene.bodies[0]?.mass ?? 0) > 0 && scene.bodies[1]?.isFixed);
  assert.doesNotMatch(Object.values(toMjcf(scene)).join("") + toUsd(scene), /NaN|Infinity/);
});

test("every file, body, mesh and prim has a name of its own, which means nothing else", async () => {
  const names = ["a", "A", "a", "a_0", "a_1", "world", "Ground", "camera", "nul", "7", "a b", "a-b", "ß"];
  const objects = names.map((name, i) => ({ name, mesh: tower, transform: over(i, 0, 0) }));
  const scene = await simulatorScene(objects, hulls);
  // A scene that a caller has put together of others has their names.
  const twice = { ...scene, bodies: [...scene.bodies, ...scene.bodies.map((body) => ({ ...body, inside: [] }))] };
  for (const one of [scene, twice]) {
    const [mjcf, urdf, usd] = [toMjcf(one), toUrdf(one), toUsd(one)];
    // Paths in an object are distinct; a surface and a part for each body, distinct without case as well.
    for (const files of [mjcf, urdf]) {
      const meshes = Object.keys(files).filter((path) => path.startsWith("meshes/"));
      assert.equal(new Set(meshes.map((path) => path.toLowerCase())).size, 2 * one.bodies.length);
    }
    const all = (text: string, pattern: RegExp) =>
      Array.from(text.matchAll(pattern), ([, name = ""]) => name.toLowerCase());
    const inMjcf = mjcf["scene.xml"] ?? "";
    const found: [kind: string, names: string[], count: number][] = [
      ["MJCF mesh", all(inMjcf, /<mesh name="([^"]*)"/g), 2 * one.bodies.length],
      ["MJCF body", ["world", ...all(inMjcf, /<body name="([^"]*)"/g)], 1 + one.bodies.length],
      [
        "URDF body",
        JSON.parse(urdf["scene.json"] ?? "").bodies.map(({ name }: { name: string }) => name),
        1 + one.bodies.length,
      ],
      ["USD prim", all(usd, /^ {4}def \w+ "([^"]*)"/gm), 3 + one.bodies.length],
    ];
    for (const [kind, list, count] of found) {
      assert.deepEqual([new Set(list).size, list.length], [count, count], `${kind}: ${list}`);
      for (const name of list) assert.match(name, /^[A-Za-z_]\w*$/, kind);
    }
    // Each body loads its own meshes: those of a box have eight vertices, all the same here, so that names have to agree.
    for (const [path, text] of Object.entries(urdf).filter(
      ([path]) => path.endsWith(".urdf") && path !== "ground.urdf",
    )) {
      const own = all(text, /<mesh filename="([^"]*)"/g);
      assert.equal(own[0], `meshes/${path.replace(".urdf", ".obj")}`.toLowerCase());
      assert.ok(
        own.every((file) => Object.keys(urdf).some((name) => name.toLowerCase() === file)),
        path,
      );
    }
  }
});

test("faces without area and repeated ones are neither weighed nor written, and the surface of a prim has its name", async () => {
  const own = [...tower.indices];
  const [a = 0, b = 0, c = 0] = own;
  const backward = own.map((_, i) => own[i - (i % 3) + 2 - (i % 3)] as number);
  for (const more of [[a, a, b], [a, b, c], [b, c, a, a, b, c], [a, c, b], backward]) {
    const spoilt = { ...tower, indices: Uint32Array.from([...more, ...own]) };
    const scene = await simulatorScene([{ name: "tower", mesh: spoilt, transform: over(0, 0, 0) }], { support: below });
    assertNear([scene.bodies[0]?.mass ?? 0], [0.8], `${more}`, 1e-5);
    const faces = (toMjcf(scene)["meshes/tower.obj"] ?? "").match(/^f /gm) ?? [];
    assert.equal(faces.length, own.length / 3, `${more}`);
    assert.match(toUsd(scene), /def Xform "tower".*def Mesh "tower".*def Mesh "tower_collider_0"/s);
  }
});

/** The results of the simulators after a second of physics. */
interface Simulated {
  mujoco: { bodies: Rested[]; cameras: { position: number[]; axes: number[]; window: number[] }[]; planes: number };
  pybullet: { bodies: Rested[]; ground: boolean };
  usd: {
    bodies: { name: string; fixed: boolean; parts: number; centerOfMass: number[] | null; position: number[] }[];
    complaints: string[];
    windows: number[][];
    [fact: string]: unknown;
  };
}
interface Rested {
  name: string;
  fixed: boolean;
  mass: number;
  parts: number;
  position?: number[];
  movedM: number;
  turnedDeg: number;
}

const python = process.env.SIM3ALIGN_SIMULATORS;
const skip = python === undefined ? "no Python with simulators: `npm run physics` installs it" : false;

function simulated(path: string): Simulated {
  const env = { ...process.env, PYTHONPATH: join(repository, "scripts", "bench"), PYTHONDONTWRITEBYTECODE: "1" };
  const { stdout, stderr } = spawnSync(python as string, ["-m", "simulators", "1", path], { env, encoding: "utf8" });
  assert.match(stdout, /^\{/m, stderr);
  // PyBullet prints its build first.
  return JSON.parse(stdout.split("\n").find((line) => line.startsWith("{")) as string) as Simulated;
}

/** Writes the files of a scene as the command line does, and returns their folder. */
function write(name: string, scene: SimulatorScene): string {
  const files: Files = { "scene.usda": toUsd(scene) };
  for (const [part, texts] of Object.entries({ mjcf: toMjcf(scene), urdf: toUrdf(scene) })) {
    for (const [path, text] of Object.entries(texts)) files[`${part}/${path}`] = text;
  }
  return writeFiles(join(folder, name), files);
}

test("MuJoCo, PyBullet and USD load a scene; its bodies stay, and have the same mass", { skip }, async () => {
  const objects: SimulatorObject[] = [
    { name: "tray", mesh: tray(), transform: over(0, 0, 0) },
    { name: "in the tray", mesh: box(0.06, 0.06, 0.06), transform: over(0.07, 0.07, 0.021), restsOn: 0 },
    { name: "leans", mesh: tower, transform: over(-0.5, 0, 0.001, 2) },
    { name: "hangs", mesh: tower, transform: over(0, 0.5, 0.4), restsOn: null },
    // Names of parts, of other bodies, and of what simulators have themselves.
    ...["tray_0", "tray", "world", "ground", "camera", "light", "physics"].map((name, i) => ({
      ...{ name, mesh: box(0.05, 0.05, 0.05), transform: over(-0.5 + 0.1 * i, 0.4, 0) },
    })),
  ];
  const camera = { fx: 610, fy: 600, cx: 300, cy: 250, width: 640, height: 480 };
  const scene = await simulatorScene(objects, { support: below, camera });
  const { mujoco, pybullet, usd } = simulated(write("simple", scene));
  const own = scene.bodies.map(({ name, isFixed, parts }) => [name, isFixed, parts.length]);
  for (const bodies of [mujoco.bodies, pybullet.bodies]) {
    for (const [i, { name, fixed, parts }] of bodies.entries()) assert.deepEqual([name, fixed, parts], own[i]);
    for (const [i, { mass, movedM, turnedDeg, fixed, name }] of bodies.entries()) {
      if (!fixed) assertNear([mass / (scene.bodies[i]?.mass ?? 0)], [1], name, 1e-5);
      assert.ok(movedM < 0.005 && turnedDeg < 5, `${name}: ${movedM} m, ${turnedDeg}°`);
    }
  }
  assert.ok((scene.bodies[1]?.position[2] ?? 1) < 0.04, "it is not on the hull of the tray");
  for (const [i, { position, name }] of pybullet.bodies.entries()) {
    assertNear(position ?? [], scene.bodies[i]?.position ?? [], `the link of ${name}`, 1e-5);
  }
  assert.deepEqual([mujoco.planes, pybullet.ground], [1, true]);
  // The camera is 1 m over the ground, and looks down: its own z is up.
  const { position = [], axes = [], window = [] } = mujoco.cameras[0] ?? {};
  assertNear([position[2] ?? 0, axes[8] ?? 0], [1, 1], "camera", 1e-5);
  // Left, right, bottom and top of the image at a distance of 1; pixel centres are at whole numbers.
  const sides = [-300.5 / 610, 339.5 / 610, -229.5 / 600, 250.5 / 600];
  assertNear(window, sides, "view of MuJoCo", 1e-5);
  assertNear(usd.windows[0] ?? [], sides, "view of USD", 1e-5);
  const { complaints, upAxis, metresPerUnit, scenes } = usd;
  assert.deepEqual([complaints, upAxis, metresPerUnit, scenes], [[], "Z", 1, 1]);
  for (const [i, { name, fixed, parts, position, centerOfMass }] of usd.bodies.entries()) {
    assert.deepEqual([name, fixed, parts], own[i]);
    assertNear(position, scene.bodies[i]?.position ?? [], "position", 1e-5);
    if (centerOfMass !== null) assertNear(centerOfMass, scene.bodies[i]?.centerOfMass ?? [], "centre", 1e-5);
  }
  writeCase("table", tableFiles());
  succeeds("scene table --quality fast --mjcf out/mjcf --urdf out/urdf --usd out/scene.usda");
  const table = simulated(join(folder, "out"));
  for (const { movedM, turnedDeg } of [...table.mujoco.bodies, ...table.pybullet.bodies]) {
    assert.ok(movedM < 0.005 && turnedDeg < 5, `${movedM} m, ${turnedDeg}°`);
  }
});
