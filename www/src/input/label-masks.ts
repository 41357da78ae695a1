/** Masks from the values of label maps, and from the annotations of COCO files. */
import { decodedRle } from "sim3align/input/coco-rle";
import type { MaskSource, NamedFile } from "../state/inputs.js";
import { once } from "../state/once.js";
import { extension, stem } from "./files.js";
import { type ReadMask, readDepth } from "./reader.js";

/** A label map: 0 is no object. */
interface Labels {
  data: Uint32Array;
  width: number;
  height: number;
  /** The values with their numbers of pixels. */
  counts: ReadonlyMap<number, number>;
}

/** Labels with fewer pixels are taken for noise, such as the blended edges of a resized map. */
const MIN_LABEL_PIXELS = 24;
/** More values than this are no labels, but an image. */
const MAX_LABELS = 64;

/** The mask of a value or of an annotation. */
export async function maskFrom({ file, label, annotation }: MaskSource): Promise<ReadMask> {
  if (annotation !== undefined) return annotationMask(await cocoOf(file), annotation);
  const { data, width, height } = await labelsOf(file);
  return { data: Uint8Array.from(data, (value) => (value === label ? 1 : 0)), width, height };
}

/** The values of a label map, or none if the file is a plain mask or a photo. */
export async function labelValues(file: NamedFile): Promise<number[]> {
  const { counts } = await labelsOf(file);
  const values = [...counts].filter(([value, count]) => value !== 0 && count >= MIN_LABEL_PIXELS);
  if (values.length < 2 || counts.size > 4 * MAX_LABELS || values.length > MAX_LABELS) return [];
  return values.map(([value]) => value).sort((a, b) => a - b);
}

const labelsOf = once(async (file: NamedFile): Promise<Labels> => {
  const bytes = await file.bytes();
  const isDeep = extension(file.path) === "npy" || (bytes[24] === 16 && bytes[25] === 0);
  const { data, width, height } = isDeep
    ? await readDepth(bytes, { depthScale: 1 }).then(({ data, ...size }) => ({ ...size, data: Uint32Array.from(data) }))
    : await coloursOf(bytes);
  const counts = new Map<number, number>();
  for (const value of data) counts.set(value, (counts.get(value) ?? 0) + 1);
  return { data, width, height, counts };
});

/** The pixels of an image: red, green, blue, alpha. At most `side` columns and rows of them, without interpolation. */
async function pixelsOf(bytes: Uint8Array, side = Number.POSITIVE_INFINITY) {
  const bitmap = await createImageBitmap(new Blob([bytes as Uint8Array<ArrayBuffer>]), {
    colorSpaceConversion: "none",
    premultiplyAlpha: "none",
  });
  const [width, height] = [Math.min(bitmap.width, side), Math.min(bitmap.height, side)];
  const context = new OffscreenCanvas(width, height).getContext("2d", { willReadFrequently: true });
  if (context === null) throw new Error("The browser could not create a canvas for the image.");
  context.imageSmoothingEnabled = false;
  context.drawImage(bitmap, 0, 0, width, height);
  bitmap.close();
  return { rgba: context.getImageData(0, 0, width, height).data, width, height };
}

/** Above this level, a pixel of a mask that was saved with losses is the object. */
const HALF = 127;
/** How far the levels of such a mask are from black and white, and from grey. */
const LOSS = 40;
/** Columns and rows that are looked at, and the share of them that has to be black or white: edges are blurred. */
const [LOOKED_AT, PLAIN_SHARE] = [96, 0.97];

/** The mask in an image that was saved with losses: its bright pixels. */
export async function maskOfPicture(file: NamedFile): Promise<ReadMask> {
  const { rgba, width, height } = await pixelsOf(await file.bytes());
  const data = Uint8Array.from({ length: width * height }, (_, i) => ((rgba[4 * i + 1] ?? 0) > HALF ? 1 : 0));
  return { data, width, height };
}

/** Whether an image shows black and white only, both of them, as a mask does. */
export async function isBlackAndWhite(file: NamedFile): Promise<boolean> {
  const found = await pixelsOf(await file.bytes(), LOOKED_AT).catch(() => null);
  if (found === null) return false;
  const { rgba } = found;
  let [black, white] = [0, 0];
  for (let i = 0; i < rgba.length; i += 4) {
    const [r = 0, g = 0, b = 0] = rgba.subarray(i, i + 3);
    if (Math.max(r, g, b) - Math.min(r, g, b) > LOSS) continue;
    if (g <= LOSS) black++;
    else if (g >= 255 - LOSS) white++;
  }
  return black > 0 && white > 0 && 4 * (black + white) >= PLAIN_SHARE * rgba.length;
}

/** The colours of an image as numbers: an 8-bit grey value g is g · 0x10101, so it is divided back. */
async function coloursOf(bytes: Uint8Array): Promise<Omit<Labels, "counts">> {
  const { rgba, width, height } = await pixelsOf(bytes);
  const data = new Uint32Array(width * height);
  for (let i = 0; i < data.length; i++) {
    const [r = 0, g = 0, b = 0] = [rgba[4 * i], rgba[4 * i + 1], rgba[4 * i + 2]];
    data[i] = r === g && g === b ? r : (r << 16) | (g << 8) | b;
  }
  return { data, width, height };
}

/** The parts of a COCO file that are used. */
interface Coco {
  images: { id: number; width: number; height: number; file_name?: string }[];
  annotations: { image_id: number; category_id?: number; segmentation: unknown }[];
  categories?: { id: number; name: string }[];
}

const cocoOf = once(async (file: NamedFile): Promise<Coco> => {
  const content = JSON.parse(new TextDecoder().decode(await file.bytes())) as Coco;
  if (!Array.isArray(content.images) || !Array.isArray(content.annotations)) {
    throw new Error("This JSON file has no images and annotations in COCO's format.");
  }
  return content;
});

/** The annotations of the image of a photo or depth map: their indices and categories. */
export async function annotationsOf(file: NamedFile, imageNames: readonly string[]) {
  const { images, annotations, categories = [] } = await cocoOf(file);
  const named = images.find(({ file_name }) => file_name !== undefined && imageNames.includes(stem(file_name)));
  const image = named ?? (images.length === 1 ? images[0] : undefined);
  return annotations.flatMap(({ image_id, category_id }, index) =>
    image !== undefined && image_id === image.id
      ? [{ index, name: categories.find(({ id }) => id === category_id)?.name ?? "" }]
      : [],
  );
}

function annotationMask({ images, annotations }: Coco, index: number): ReadMask {
  const annotation = annotations[index];
  const image = images.find(({ id }) => id === annotation?.image_id);
  if (annotation === undefined || image === undefined) throw new Error("The annotation is no longer in the file.");
  const { segmentation } = annotation;
  if (!Array.isArray(segmentation)) {
    const { data, width, height } = decodedRle("segmentation", segmentation);
    return { data: Uint8Array.from(data), width, height };
  }
  return polygonMask(segmentation as number[][], image.width, image.height);
}

/** The pixels whose centres are in one of the polygons, x and y in turn; the centre of the first pixel is 0.5, 0.5. */
function polygonMask(polygons: readonly (readonly number[])[], width: number, height: number): ReadMask {
  const data = new Uint8Array(width * height);
  for (const points of polygons) {
    for (let v = 0; v < height; v++) {
      const crossings: number[] = [];
      for (let i = 0; i < points.length; i += 2) {
        const next = (i + 2) % points.length;
        const [x0, y0] = [points[i] as number, points[i + 1] as number];
        const [x1, y1] = [points[next] as number, points[next + 1] as number];
        if (y0 > v + 0.5 !== y1 > v + 0.5) crossings.push(x0 + ((v + 0.5 - y0) / (y1 - y0)) * (x1 - x0));
      }
      crossings.sort((a, b) => a - b);
      for (let k = 0; k + 1 < crossings.length; k += 2) {
        const from = Math.max(0, Math.ceil((crossings[k] as number) - 0.5));
        const to = Math.min(width - 1, Math.ceil((crossings[k + 1] as number) - 0.5) - 1);
        for (let u = from; u <= to; u++) data[v * width + u] = 1;
      }
    }
  }
  return { data, width, height };
}
