/**
 * A tiny dataset in the layout of BOP, made independently of the package: three objects (an uneven one, a brick, and a can)
 * in four images, each of which hides a part of another. `node tests/support/bop-dataset.ts FOLDER` writes it.
 */
import { writeFileSync } from "node:fs";
import { join } from "node:path";
import { maskPng, png, writeFiles } from "./files.js";
import { Random } from "./random.js";
import { blob, cuboid, type Mesh, type Pose, product, render, rotationRows } from "./scene.js";

export const [width, height] = [640, 480];
export const camera = { fx: 610.5, fy: 612.25, cx: 318.25, cy: 241.5 };

/** Metres: a wall behind the objects. */
const WALL = 1.4;
/** A pixel is a part of the mask where the object is at most this far behind the depth map, metres. */
const VISIBLE = 0.015;

/** The models, millimetres. */
export const models: readonly { mesh: Mesh; info: object }[] = [
  { mesh: rounded(blob(24, 36), 45), info: {} },
  {
    mesh: rounded(cuboid(30, 45, 60), 1),
    info: {
      symmetries_discrete: [
        [-1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1],
        [-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1],
        [1, 0, 0, 0, 0, -1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1],
      ],
    },
  },
  {
    mesh: rounded(can(35, 55, 48), 1),
    info: { symmetries_continuous: [{ axis: [0, 0, 1], offset: [0, 0, 0] }] },
  },
];

/** An object in an image: the id of its model and its pose, camera from model in metres. */
export interface Placed {
  id: number;
  pose: Pose;
}

/** The images: scene, image, and what is there. */
export const images: readonly { scene: number; image: number; objects: readonly Placed[] }[] = [
  {
    scene: 1,
    image: 0,
    objects: [placed(1, [0.3, -0.5, 0.2, 0.8], [-0.1, 0, 0.7]), placed(2, [0.2, 0.4, 0.1, 0.9], [0.08, 0, 0.75])],
  },
  {
    scene: 1,
    image: 7,
    objects: [
      placed(2, [0.5, 0.1, 0.3, 0.8], [-0.12, 0.02, 0.7]),
      placed(3, [0.6, 0.1, -0.1, 0.7], [0.03, -0.04, 0.62]),
      // Half behind the can, and mostly hidden behind the first brick.
      placed(2, [0.1, 0.6, 0.2, 0.7], [0.1, -0.02, 0.8]),
      placed(2, [0.2, 0.1, 0.6, 0.7], [-0.16, 0.03, 0.95]),
    ],
  },
  {
    scene: 2,
    image: 3,
    objects: [placed(3, [0.8, 0.2, 0.1, 0.5], [0, 0.05, 0.6]), placed(1, [-0.4, 0.3, 0.7, 0.5], [0.06, 0, 0.72])],
  },
  // Cut off by the border of the image.
  {
    scene: 3,
    image: 1,
    objects: [placed(1, [0.9, 0.1, 0.3, 0.2], [-0.32, 0.1, 0.7]), placed(3, [0.3, 0.3, 0.1, 0.9], [0.1, -0.1, 0.8])],
  },
];

function placed(id: number, q: Pose["rotation"], translation: Pose["translation"]): Placed {
  const length = Math.hypot(...q);
  return { id, pose: { scale: 0.001, rotation: q.map((x) => x / length) as Pose["rotation"], translation } };
}

/** Rounded to the digits of the files: sines differ in their last digit from one engine to another. */
function rounded({ positions, indices }: Mesh, scale: number): Mesh {
  return { positions: positions.map((x) => Number((scale * x).toFixed(3))), indices };
}

/** A closed cylinder about z. */
function can(radius: number, half: number, sides: number): Mesh {
  const positions = [0, 0, -half, 0, 0, half];
  const indices: number[] = [];
  for (let i = 0; i < sides; i++) {
    const angle = (2 * Math.PI * i) / sides;
    const [x, y] = [radius * Math.cos(angle), radius * Math.sin(angle)];
    positions.push(x, y, -half, x, y, half);
    const [a, b] = [2 + 2 * i, 2 + 2 * ((i + 1) % sides)];
    indices.push(0, b, a, 1, a + 1, b + 1, a, b, b + 1, a, b + 1, a + 1);
  }
  return { positions: Float32Array.from(positions), indices: Uint32Array.from(indices) };
}

/** A mesh as a text PLY. */
export function plyText({ positions, indices }: Mesh): string {
  const rows = (values: ArrayLike<number>, prefix: string, show: (x: number) => string) =>
    Array.from(
      { length: values.length / 3 },
      (_, i) => `${prefix}${[0, 1, 2].map((k) => show(values[3 * i + k] ?? 0)).join(" ")}`,
    );
  return [
    "ply\nformat ascii 1.0",
    `element vertex ${positions.length / 3}\nproperty float x\nproperty float y\nproperty float z`,
    `element face ${indices.length / 3}\nproperty list uchar int vertex_indices\nend_header`,
    ...rows(positions, "", (x) => `${Number(x.toFixed(4))}`),
    ...rows(indices, "3 ", String),
    "",
  ].join("\n");
}

/** The largest distance between two vertices. */
export function diameter({ positions }: Mesh): number {
  let squared = 0;
  for (let i = 0; i < positions.length; i += 3) {
    for (let j = 0; j < i; j += 3) {
      const [x, y, z] = [0, 1, 2].map((k) => (positions[i + k] ?? 0) - (positions[j + k] ?? 0)) as [
        number,
        number,
        number,
      ];
      squared = Math.max(squared, x * x + y * y + z * z);
    }
  }
  return Math.sqrt(squared);
}

/** An entry of `scene_gt.json`. */
const entryOf = ({ id, pose }: Placed) => ({
  obj_id: id,
  cam_R_m2c: rotationRows(pose.rotation).flat(),
  cam_t_m2c: pose.translation.map((x) => 1000 * x),
});

/** Writes the dataset; its name is that of the folder. Returns the masks by their paths in it. */
export function writeBop(folder: string): Map<string, Uint8Array> {
  const write = (path: string, content: Uint8Array | string | object) => writeFiles(folder, { [path]: content });
  for (const place of ["models", "models_eval"]) {
    for (const [i, { mesh }] of models.entries()) write(join(place, `obj_00000${i + 1}.ply`), plyText(mesh));
    const infos = models.map(({ mesh, info }, i) => [`${i + 1}`, { diameter: diameter(mesh), ...info }]);
    write(join(place, "models_info.json"), Object.fromEntries(infos));
  }
  const masks = new Map<string, Uint8Array>();
  const files = new Map<string, Record<string, unknown>>();
  const targets: object[] = [];
  for (const { scene, image, objects } of images) {
    const own = join("test", `00000${scene}`);
    const seen = objects.map(({ id, pose }) => render(models[id - 1]?.mesh as Mesh, pose, camera, width, height, WALL));
    const depth = new Float32Array(width * height).fill(WALL);
    for (const view of seen) for (const [i, z] of view.depth.entries()) depth[i] = Math.min(depth[i] ?? 0, z);
    // No readings in a few rows.
    for (let v = 200; v < 204; v++) depth.fill(0, v * width, (v + 1) * width);
    const infos = seen.map((view, i) => {
      const mask = view.mask.map(
        (inside, p) => inside * Number(depth[p] === 0 || (view.depth[p] ?? 0) - (depth[p] ?? 0) <= VISIBLE),
      );
      masks.set(join(own, "mask_visib", `00000${image}_00000${i}.png`), mask);
      const count = (pixels: Uint8Array) => pixels.reduce((sum, x) => sum + x, 0);
      return { visib_fract: Number((count(mask) / count(view.mask)).toFixed(4)) };
    });
    write(
      join(own, "depth", `00000${image}.png`),
      png(
        Uint16Array.from(depth, (z) => Math.round(10_000 * z)),
        width,
        height,
      ),
    );
    const cam_K = [camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1];
    const contents = {
      "scene_camera.json": { cam_K, depth_scale: 0.1 },
      "scene_gt.json": objects.map(entryOf),
      "scene_gt_info.json": infos,
    };
    for (const [name, content] of Object.entries(contents)) {
      const path = join(own, name);
      files.set(path, { ...files.get(path), [`${image}`]: content });
    }
    for (const id of [...new Set(objects.map((object) => object.id))].sort()) {
      // One brick of the three is hardly visible, and no target.
      const inst_count = Math.min(2, objects.filter((object) => object.id === id).length);
      targets.push({ scene_id: scene, im_id: image, obj_id: id, inst_count });
    }
  }
  for (const [path, content] of files) write(path, content);
  for (const [path, mask] of masks) write(path, maskPng(mask, width, height));
  write("test_targets_bop19.json", targets);
  return masks;
}

/** Poses near the true ones, some of them wrong, as a results file of BOP. */
export function resultsText(): string {
  const random = new Random(5);
  const lines = images.flatMap(({ scene, image, objects }) =>
    objects.flatMap((object, i) => {
      // Errors from nearly none to about the diameter.
      const size = [0.02, 0.08, 0.2, 0.5][random.whole(0, 3)] ?? 0;
      const estimates = [moved(object, size, random), ...(i === 0 ? [moved(object, 2 * size, random)] : [])];
      return estimates.map(({ cam_R_m2c, cam_t_m2c }) => {
        const score = random.between(0, 1).toFixed(4);
        return [scene, image, object.id, score, cam_R_m2c.join(" "), cam_t_m2c.join(" "), 0.25 * image + 0.5].join(",");
      });
    }),
  );
  return ["scene_id,im_id,obj_id,score,R,t,time", ...lines, ""].join("\n");
}

/** A turn and a shift of about this size; that of the brick and the can after a symmetry. */
function moved({ id, pose }: Placed, size: number, random: Random) {
  const [x, y, z, w] = random.list(4, -size, size) as Pose["rotation"];
  const symmetry: Pose["rotation"] = id === 1 ? [0, 0, 0, 1] : id === 2 ? [0, 0, 1, 0] : [0, 0, 0.6, 0.8];
  const turn = product(product(pose.rotation, symmetry), [x, y, z, 1 + w]);
  const length = Math.hypot(...turn);
  const rotation = turn.map((c) => c / length) as Pose["rotation"];
  const shift = random.list(3, -60 * size, 60 * size);
  const { cam_t_m2c } = entryOf({ id, pose });
  return {
    cam_R_m2c: rotationRows(rotation)
      .flat()
      .map((c) => Number(c.toFixed(9))),
    cam_t_m2c: cam_t_m2c.map((c, i) => Number((c + (shift[i] ?? 0)).toFixed(6))),
  };
}

const [, script, folder] = process.argv;
if (script?.endsWith("bop-dataset.ts") && folder !== undefined) {
  writeBop(folder);
  writeFileSync(join(folder, "..", "test_tudl-test.csv"), resultsText());
}
