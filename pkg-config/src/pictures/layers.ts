/** Layers of pictures: the observation, and drawings over it. */
import { depthColour, MASK, MESH, type Rgb } from "./colours.js";
import type { Picture } from "./png.js";
import { lightAt, outlineOf } from "./shading.js";
import type { Shot } from "./shot.js";
import type { View } from "./view.js";

/** The observation: the photo or, without one, the depth in colours. */
export function ground(shot: Shot, view: View): Picture {
  const { photo, width: columns, height: rows } = shot;
  return photo === undefined ? depthGround(shot, view) : photoGround(photo, columns, rows, view);
}

function photoGround({ data: pixels, ...photo }: Picture, columns: number, rows: number, view: View): Picture {
  const { width, height } = view;
  const data = new Uint8Array(3 * width * height);
  const [scaleX, scaleY] = [photo.width / columns, photo.height / rows];
  // Pixels of the photo per pixel of the view: their mean.
  const count = Math.min(Math.max(1, Math.round(scaleX / view.zoom)), 8);
  const nothing = depthColour(null);
  for (let i = 0; i < width * height; i++) {
    const [x, y] = [i % width, Math.floor(i / width)];
    let [red, green, blue, seen] = [0, 0, 0, 0];
    for (let k = 0; k < count * count; k++) {
      const u = Math.floor((view.left + (x + ((k % count) + 0.5) / count) / view.zoom) * scaleX);
      const v = Math.floor((view.top + (y + (Math.floor(k / count) + 0.5) / count) / view.zoom) * scaleY);
      if (u < 0 || v < 0 || u >= photo.width || v >= photo.height) continue;
      const at = 3 * (v * photo.width + u);
      seen += 1;
      red += pixels[at] as number;
      green += pixels[at + 1] as number;
      blue += pixels[at + 2] as number;
    }
    data[3 * i] = seen === 0 ? nothing[0] : Math.round(red / seen);
    data[3 * i + 1] = seen === 0 ? nothing[1] : Math.round(green / seen);
    data[3 * i + 2] = seen === 0 ? nothing[2] : Math.round(blue / seen);
  }
  return { data, width, height };
}

function depthGround(shot: Shot, view: View): Picture {
  const { width, height } = view;
  const depth = view.sampled(shot.depth, shot.width, shot.height);
  const readings = depth.filter((z) => z > 0).sort();
  const at = (share: number) => readings[Math.floor(share * (readings.length - 1))] ?? 0;
  const [near, far] = [at(0.01), at(0.99)];
  const data = new Uint8Array(3 * width * height);
  depth.forEach((z, i) => {
    // A few levels, of which small files are made.
    data.set(depthColour(z > 0 ? Math.round((200 * (z - near)) / (far - near || 1)) / 200 : null), 3 * i);
  });
  return { data, width, height };
}

/** Sets the colour and the opacity of a pixel of a layer. */
function paint(layer: Uint8Array, i: number, [red, green, blue]: Rgb, opacity: number): void {
  layer[4 * i] = red;
  layer[4 * i + 1] = green;
  layer[4 * i + 2] = blue;
  layer[4 * i + 3] = opacity;
}

/** The outlines of the mask and of the mesh. */
export function outlines(mask: Float32Array, mesh: Float32Array, { width, height }: View): Picture {
  const thickness = Math.max(2, Math.round(width / 320));
  const isMask = outlineOf({ data: mask, width, height }, thickness);
  const isMesh = outlineOf({ data: mesh, width, height }, thickness);
  const data = new Uint8Array(4 * width * height);
  for (let i = 0; i < width * height; i++) {
    if (isMesh(i)) paint(data, i, MESH, 255);
    else if (isMask(i)) paint(data, i, MASK, 255);
  }
  return { data, width, height };
}

/** The mesh, shaded by the slope of its surface. */
export function shaded(mesh: Float32Array, { width, height }: View, focal: { fx: number; fy: number }): Picture {
  const shape = { data: mesh, width, height };
  const data = new Uint8Array(4 * width * height);
  for (let i = 0; i < width * height; i++) {
    if (mesh[i] === 0) continue;
    const light = lightAt(shape, i, focal);
    // A few levels, of which small files are made.
    const tone = (part: number) => Math.min(255, 8 * Math.round(Math.min(255, part * light) / 8));
    paint(data, i, [tone(MESH[0]), tone(MESH[1]), tone(MESH[2])], 235);
  }
  return { data, width, height };
}

/** A layer through which what is below stays visible. */
export function translucent({ data, ...size }: Picture): Picture {
  return { data: data.map((byte, i) => (i % 4 === 3 ? byte * 0.45 : byte)), ...size };
}

/** A layer over a picture, as one picture. */
export function over(below: Picture, ...layers: readonly Picture[]): Picture {
  const data = Uint8Array.from(below.data);
  for (const { data: above } of layers) {
    for (let i = 0; i < data.length / 3; i++) {
      const share = (above[4 * i + 3] as number) / 255;
      if (share === 0) continue;
      for (let k = 0; k < 3; k++) {
        data[3 * i + k] = (data[3 * i + k] as number) * (1 - share) + (above[4 * i + k] as number) * share;
      }
    }
  }
  return { data, width: below.width, height: below.height };
}
