/** Masks in JSON: one table of the layouts that programs write. Loaded only for such a mask. */
import type { LoadFormats } from "../modules/readers.js";
import { failure } from "../values/error.js";
import { numbersIn } from "../values/json.js";
import { isRecord } from "../values/kinds.js";
import type { ImageSize, PixelArray } from "../values/pixels.js";
import { flattened } from "../values/validation.js";
import { callReader } from "./bytes.js";
import { decodedRle } from "./coco-rle.js";
import type { ReadMask } from "./mask.js";
import { filledAreas, type Ring } from "./polygons.js";

/** A mask among those of a file. */
interface Entry {
  /** What its file says of it, for people. */
  name: string;
  /** The size of its image; `undefined` if the file has none. */
  size?: ImageSize | undefined;
  /** COCO's run lengths; or areas; or a PNG, base64, at a place in the image; Supervisely compresses it once more. */
  rle?: unknown;
  areas?: readonly (readonly Ring[])[];
  png?: { base64: string; left: number; top: number };
}

/** A layout of JSON. */
interface Layout {
  name: string;
  /** Keys of the file and of its masks that are used, or that do not matter, with spaces between them. */
  keys: string;
  /** The records of the masks; `undefined` for another layout. */
  find(json: unknown): unknown[] | undefined;
  /** The mask of a record; `undefined` for one that has no area. */
  entry(record: Record<string, unknown>, file: Record<string, unknown>): Entry | undefined;
}

const layouts: readonly Layout[] = [
  {
    name: "COCO (a file, annotations, or a mask), SAM's list of masks",
    keys: `segmentation size counts id image_id category_id category bbox area iscrowd score predicted_iou point_coords
      stability_score crop_box label class_name attributes keypoints num_keypoints images annotations categories info
      licenses ignore caption bbox_mode image time scene_id image_path box_format img_width img_height`,
    find(json) {
      if (isRecord(json) && Array.isArray(json.annotations)) return json.annotations;
      if (isCorners(json)) return [{ segmentation: [json] }];
      if (isPolygons(json)) return [{ segmentation: json }];
      const all = Array.isArray(json) ? json : [json];
      return all.some((one) => isRecord(one) && (isSegmentation(one.segmentation) || isRle(one))) ? all : undefined;
    },
    entry(record, { images, categories }) {
      const segmentation = isRle(record) ? record : record.segmentation;
      const image = byId(images, record.image_id);
      const size = sizeIn(image?.height, image?.width) ?? sizeIn(...(numbersIn(record.size, 2) ?? []));
      const { id, area } = record;
      const category =
        byId(categories, record.category_id)?.name ?? record.category ?? record.label ?? record.class_name;
      const name = facts({ id, category, image: image?.file_name, area });
      if (isRle(segmentation)) return { name, rle: segmentation };
      const areas = isPolygons(segmentation) ? segmentation.map((ring) => [ringOf(ring) ?? []]) : undefined;
      return areas && { name, size, areas };
    },
  },
  {
    name: "LabelMe",
    keys: `version flags shapes imagePath imageData imageHeight imageWidth lineColor fillColor label points group_id
      description shape_type mask line_color fill_color score difficult attributes kie_linking text cells`,
    find: (json) => (isRecord(json) && Array.isArray(json.shapes) ? json.shapes : undefined),
    entry({ label, group_id: group, shape_type: type = "polygon", points, mask }, { imageHeight, imageWidth }) {
      const [name, size] = [facts({ label, group, type }), sizeIn(imageHeight, imageWidth)];
      const ring = ringOf(points);
      if (ring === undefined) return undefined;
      if (type === "mask" && typeof mask === "string") {
        return { name, size, png: { base64: mask, left: Math.round(ring[0] ?? 0), top: Math.round(ring[1] ?? 0) } };
      }
      const filled = { polygon: ring, rotation: ring, rectangle: rectangle(ring), circle: circle(ring) }[String(type)];
      return filled && { name, size, areas: [[filled]] };
    },
  },
  {
    name: "VGG Image Annotator",
    keys: `filename size regions file_attributes shape_attributes region_attributes base64_img_data fileref
      _via_img_metadata _via_settings _via_attributes _via_data_format_version _via_image_id_list`,
    find(json) {
      const files = isRecord(json)
        ? Object.values(isRecord(json._via_img_metadata) ? json._via_img_metadata : json)
        : [];
      const all = files.flatMap((file) =>
        isRecord(file) && file.regions !== undefined ? Object.values(file.regions as object) : [],
      );
      return all.length > 0 && all.every((region) => isRecord(region) && isRecord(region.shape_attributes))
        ? all
        : undefined;
    },
    entry({ shape_attributes: shape, region_attributes: of }) {
      const { name: type, all_points_x: x, all_points_y: y, ...box } = shape as Record<string, unknown>;
      const name = facts({ ...(isRecord(of) ? of : {}), type });
      const sides = [box.x, box.y, Number(box.x) + Number(box.width), Number(box.y) + Number(box.height)];
      const ring =
        type === "rect"
          ? rectangle(sides as number[])
          : Array.isArray(x) && Array.isArray(y)
            ? ringOf(x.map((u, i) => [u, y[i]]))
            : undefined;
      return ring && { name, areas: [[ring]] };
    },
  },
  {
    name: "Supervisely, ISAT",
    keys: `description tags size objects id classId classTitle labelerLogin createdAt updatedAt geometryType points
      nnCreated nnUpdated info category group segmentation area layer bbox iscrowd note bitmap shape`,
    find: (json) => (isRecord(json) && Array.isArray(json.objects) ? json.objects : undefined),
    entry({ classTitle, category = classTitle, id, group, points, segmentation, bitmap }, { size, info }) {
      const of = isRecord(size) ? size : isRecord(info) ? info : {};
      const [left, top] = (isRecord(bitmap) && numbersIn(bitmap.origin, 2)) || [];
      if (isRecord(bitmap) && typeof bitmap.data === "string" && left !== undefined && top !== undefined) {
        const name = facts({ category, id, group });
        return { name, size: sizeIn(of.height, of.width), png: { base64: bitmap.data, left, top } };
      }
      const { exterior, interior = [] } = isRecord(points) ? points : { exterior: segmentation };
      const rings = [exterior, ...(Array.isArray(interior) ? interior : [])].map(ringOf);
      if (!rings.every((ring) => ring !== undefined)) return undefined;
      return { name: facts({ category, id, group }), size: sizeIn(of.height, of.width), areas: [rings] };
    },
  },
  {
    name: "Datumaro",
    keys: `dm_format_version media_type infos categories items id type attributes group label_id rle z_order points
      object_id size`,
    find: (json) =>
      isRecord(json) && Array.isArray(json.items)
        ? json.items.flatMap((item) =>
            isRecord(item) && Array.isArray(item.annotations)
              ? item.annotations.map((one) => ({ ...one, size: isRecord(item.image) ? item.image.size : undefined }))
              : [],
          )
        : undefined,
    entry({ id, label_id: label, type, rle, points, size }) {
      const name = facts({ id, label, type });
      if (isRle(rle)) return { name, rle };
      const ring = type === "polygon" ? ringOf(points) : undefined;
      return ring && { name, size: sizeIn(...(numbersIn(size, 2) ?? [])), areas: [[ring]] };
    },
  },
];

/**
 * The mask in JSON.
 * @param index its place among several
 * @param size that of the depth map, for polygons whose file states none
 */
export async function maskInJson(
  argument: string,
  json: unknown,
  index: unknown,
  size: ImageSize | undefined,
  formats: LoadFormats,
): Promise<ReadMask> {
  const [found] = layoutsOf(json);
  if (found === undefined) {
    const keys = isRecord(json)
      ? `JSON with the keys ${Object.keys(json).slice(0, 8).join(", ")}`
      : "JSON of another layout";
    const expected = `a mask as ${layouts.map(({ name }) => name).join("; ")} write it`;
    const remedy = "Encode the mask as COCO RLE, for example with pycocotools, or pass a PNG.";
    throw failure("UNSUPPORTED_FORMAT", argument, keys, expected, remedy);
  }
  const file = isRecord(json) ? json : {};
  const { layout, list } = found;
  const records = list.filter(isRecord);
  const all = records.map((record) => layout.entry(record, file));
  const entries = all.filter((entry) => entry !== undefined);
  const entry = chosen(argument, entries, index);
  const [first] = records;
  const isFile = first !== undefined && first !== file;
  const known = new Set(layout.keys.split(/\s+/));
  const unknown = [...(isFile ? Object.keys(file) : []), ...records.flatMap(Object.keys)].filter(
    (key) => !known.has(key) && !isRecord(file[key]),
  );
  const unread = [
    ...new Set(unknown.map((key) => `the key \`${key}\` of the mask file`)),
    ...all.flatMap((one, i) => (one === undefined ? [`entry ${i} of the mask file, which has no area`] : [])),
  ];
  const mask = await pixelsOf(argument, entry, size, formats);
  const reading = entries.length > 1 ? `entry ${index} of ${entries.length}: ${entry.name}` : undefined;
  return { ...mask, ...(reading === undefined ? {} : { reading }), unread };
}

/** The layouts of JSON, each with the records of the masks. */
function* layoutsOf(json: unknown) {
  for (const layout of layouts) {
    const list = layout.find(json);
    if (list !== undefined) yield { layout, list };
  }
}

/** Names in an error. */
const LISTED = 12;

function chosen(argument: string, entries: readonly Entry[], index: unknown): Entry {
  const entry = index === undefined && entries.length === 1 ? entries[0] : entries[Number(index)];
  if (entry !== undefined) return entry;
  const names = entries.slice(0, LISTED).map(({ name }, i) => `${i}: ${name || "no name"}`);
  const list = [...names, ...(entries.length > LISTED ? ["…"] : [])].join("; ");
  const found = entries.length === 0 ? "JSON without a mask" : `${entries.length} masks (${list})`;
  const expected = index === undefined ? "one mask" : `one at place ${index}`;
  const remedy =
    entries.length === 0
      ? "Its entries may have boxes alone: pass a file with outlines or run lengths, or a PNG."
      : "Pass the place of the object's mask in the file, from 0, as `maskIndex`.";
  throw failure("INVALID_ARGUMENT", argument, found, expected, remedy);
}

async function pixelsOf(
  argument: string,
  { rle, areas, png, size: own }: Entry,
  ofDepth: ImageSize | undefined,
  formats: LoadFormats,
): Promise<PixelArray<Uint8Array>> {
  if (rle !== undefined) return decodedRle(argument, rle);
  const size = own ?? ofDepth;
  if (size === undefined) {
    const remedy = "Write the size of the image into the file, or pass the mask as PNG.";
    throw failure("UNSUPPORTED_FORMAT", argument, "polygons without the size of their image", "a size", remedy);
  }
  if (png !== undefined) {
    const bytes = await inflated(
      argument,
      Uint8Array.from(decodedBase64(argument, png.base64), (letter) => letter.charCodeAt(0)),
    );
    const box = await callReader(formats, argument, bytes, (readers) => readers.readMask(bytes));
    const data = new Uint8Array(size.width * size.height);
    for (let i = 0; i < box.data.length; i++) {
      const [u, v] = [png.left + (i % box.width), png.top + Math.floor(i / box.width)];
      if (u >= 0 && v >= 0 && u < size.width && v < size.height) data[v * size.width + u] = box.data[i] as number;
    }
    return { data, ...size };
  }
  const corners = (areas ?? []).flat(2);
  const reach = [0, 1].map((axis) => corners.reduce((most, x, i) => (i % 2 === axis ? Math.max(most, x) : most), 0));
  // A corner may be on the far edge of the last pixel.
  if ((reach[0] as number) > size.width + 1 || (reach[1] as number) > size.height + 1) {
    const found = `polygons up to ${reach.map(Math.round).join(", ")}`;
    const whose = own === undefined ? "the depth map, as the file states no size" : "its image, as the file states it";
    const remedy = "Write the size of the image that was annotated into the file.";
    throw failure(
      "SIZE_MISMATCH",
      argument,
      found,
      `corners within ${size.width} × ${size.height} pixels, the size of ${whose}`,
      remedy,
    );
  }
  return { data: filledAreas(areas ?? [], size), ...size };
}

/** The bytes of a PNG that may have been compressed once more, by zlib. */
async function inflated(argument: string, bytes: Uint8Array<ArrayBuffer>): Promise<Uint8Array> {
  if (bytes[0] !== ZLIB) return bytes;
  try {
    const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
    return new Uint8Array(await new Response(stream).arrayBuffer());
  } catch (cause) {
    const remedy = "Save the annotation again.";
    throw failure("CORRUPT_FILE", argument, "a bitmap that can't be decompressed", "a PNG", remedy, cause);
  }
}

/** The first byte of a stream of zlib. */
const ZLIB = 0x78;

function decodedBase64(argument: string, text: string): string {
  try {
    return atob(text);
  } catch (cause) {
    const remedy = "Save the annotation again.";
    throw failure("CORRUPT_FILE", argument, "a mask that is not base64", "a PNG in base64", remedy, cause);
  }
}

const isRle = (value: unknown): boolean => isRecord(value) && value.counts !== undefined && value.size !== undefined;
const isSegmentation = (value: unknown): boolean => isRle(value) || isPolygons(value);

/** Whether a value is what COCO has for most annotations: arrays of coordinates. */
const isPolygons = (value: unknown): value is unknown[] =>
  Array.isArray(value) &&
  value.length > 0 &&
  value.every((ring) => (ringOf(ring)?.length ?? 0) >= 6) &&
  // The rows of a mask, which are no coordinates.
  value.some((ring) => ringOf(ring)?.some((x) => x > 1));

/** Whether a value is the corners of one polygon, [x, y] each. */
const isCorners = (value: unknown): boolean =>
  Array.isArray(value) && value.length > 2 && value.every((corner) => numbersIn(corner, 2) !== null);

const byId = (list: unknown, id: unknown): Record<string, unknown> | undefined =>
  Array.isArray(list) ? list.find((item) => isRecord(item) && item.id === id) : undefined;

const sizeIn = (height?: unknown, width?: unknown): ImageSize | undefined =>
  [width, height].every((side) => Number.isSafeInteger(side) && (side as number) > 0)
    ? { width: width as number, height: height as number }
    : undefined;

/** The coordinates of at least two points. */
function ringOf(points: unknown): Ring | undefined {
  const numbers = flattened(points);
  const isRing = numbers !== null && numbers.length >= 4 && numbers.length % 2 === 0 && numbers.every(Number.isFinite);
  return isRing ? (numbers as number[]) : undefined;
}

/** A rectangle by two opposite corners, or by all four. */
const rectangle = (ring: Ring): Ring => {
  const [x0 = 0, y0 = 0, x1 = 0, y1 = 0] = ring;
  return ring.length > 4 ? ring : [x0, y0, x1, y0, x1, y1, x0, y1];
};

/** A circle by its centre and a point on it, as a polygon. */
function circle([x = 0, y = 0, u = 0, v = 0]: Ring): Ring {
  const radius = Math.hypot(u - x, v - y);
  const at = (i: number) => (Math.PI * i) / 64;
  return Array.from({ length: 128 }, (_, i) => [x + radius * Math.cos(at(i)), y + radius * Math.sin(at(i))]).flat();
}

const facts = (known: Record<string, unknown>): string =>
  Object.entries(known)
    .filter(([, value]) => ["string", "number"].includes(typeof value))
    .map(([name, value]) => `${name} ${value}`)
    .join(", ");
