/** EXIF data, and photos with them, built byte by byte. */
import { png, pngChunk } from "./files.js";

type Value = number | string | { rational: [number, number] };

const tags = {
  make: 0x010f,
  model: 0x0110,
  orientation: 0x0112,
  exif: 0x8769,
  focalLength: 0x920a,
  pixelX: 0xa002,
  pixelY: 0xa003,
  planeX: 0xa20e,
  planeUnit: 0xa210,
  zoom: 0xa404,
  focal35: 0xa405,
} as const;

/** Values of tags. */
export type ExifFields = Partial<Record<keyof typeof tags, Value>>;

/** EXIF data: a TIFF header, the directory of the image and that of the camera. */
export function tiff(image: ExifFields, camera: ExifFields, isLittle: boolean): Buffer {
  const number = (value: number, bytes: number) => {
    const found = Buffer.alloc(bytes);
    if (isLittle) found.writeUIntLE(value, 0, bytes);
    else found.writeUIntBE(value, 0, bytes);
    return found;
  };
  const u16 = (value: number) => number(value, 2);
  const u32 = (value: number) => number(value, 4);
  const directory = (fields: ExifFields, start: number) => {
    const entries = Object.entries(fields).sort(
      ([a], [b]) => tags[a as keyof ExifFields] - tags[b as keyof ExifFields],
    );
    let extra = Buffer.alloc(0);
    const after = start + 2 + 12 * entries.length + 4;
    const list = entries.map(([name, value]) => {
      const tag = u16(tags[name as keyof ExifFields]);
      const stored = (type: number, count: number, bytes: Buffer) => {
        if (bytes.length <= 4)
          return Buffer.concat([tag, u16(type), u32(count), bytes, Buffer.alloc(4 - bytes.length)]);
        const at = u32(after + extra.length);
        extra = Buffer.concat([extra, bytes]);
        return Buffer.concat([tag, u16(type), u32(count), at]);
      };
      if (typeof value === "string") return stored(2, value.length + 1, Buffer.from(`${value}\0`, "latin1"));
      if (typeof value === "object") return stored(5, 1, Buffer.concat(value.rational.map(u32)));
      return name === "exif" || name.startsWith("pixel") ? stored(4, 1, u32(value)) : stored(3, 1, u16(value));
    });
    return Buffer.concat([u16(entries.length), ...list, u32(0), extra]);
  };
  const first = (pointer: number) => directory({ ...image, exif: pointer }, 8);
  const at = 8 + first(0).length;
  const head = Buffer.concat([Buffer.from(isLittle ? "II" : "MM"), u16(42), u32(8)]);
  return Buffer.concat([head, first(at), directory(camera, at)]);
}

/** A PNG of 3 × 2 pixels with EXIF data. */
export function pngWith(exif: Buffer): Uint8Array {
  const file = png(Uint8Array.of(0, 50, 100, 150, 200, 250), 3, 2);
  const end = 8 + 12 + 13;
  return new Uint8Array(Buffer.concat([file.subarray(0, end), pngChunk("eXIf", exif), file.subarray(end)]));
}

const segment = (marker: number, content: Uint8Array) => {
  const head = Buffer.from([0xff, marker, 0, 0]);
  head.writeUInt16BE(content.length + 2, 2);
  return Buffer.concat([head, content]);
};

const exifSegment = (exif: Buffer) => segment(0xe1, Buffer.concat([Buffer.from("Exif\0\0", "latin1"), exif]));

/** The start of a grey JPEG with EXIF data, up to the header of its pixels. */
export function jpegHead(exif: Buffer, width = 24, height = 16): Uint8Array {
  const frame = Buffer.from([8, 0, 0, 0, 0, 1, 1, 0x11, 0]);
  frame.writeUInt16BE(height, 1);
  frame.writeUInt16BE(width, 3);
  return new Uint8Array(Buffer.concat([Buffer.from([0xff, 0xd8]), exifSegment(exif), segment(0xc0, frame)]));
}

/** A JPEG of one grey with EXIF data. Each of its blocks is two bits: no change of the mean, and no detail. */
export function greyJpeg(exif: Buffer, width: number, height: number): Uint8Array {
  const quantisation = segment(0xdb, new Uint8Array(65).fill(1).fill(0, 0, 1));
  // One code, "0", for the symbol 0.
  const code = (table: number) => segment(0xc4, Uint8Array.of(table, 1, ...new Uint8Array(15), 0));
  const scan = segment(0xda, Uint8Array.of(1, 1, 0, 0, 63, 0));
  const blocks = Math.ceil(width / 8) * Math.ceil(height / 8);
  const bits = new Uint8Array(Math.ceil(blocks / 4));
  const parts = [jpegHead(exif, width, height), quantisation, code(0x00), code(0x10), scan, bits, [0xff, 0xd9]];
  return new Uint8Array(Buffer.concat(parts.map((part) => Uint8Array.from(part))));
}
