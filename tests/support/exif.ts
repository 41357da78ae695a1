/** EXIF data, made byte by byte, independently of the package's reader. */

/** The value of a field. */
export type Value = number | string | { rational: [number, number] };

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

export type Fields = Partial<Record<keyof typeof tags, Value>>;

/** EXIF data: a TIFF header, the directory of the image and that of the camera. */
export function tiff(image: Fields, camera: Fields, isLittle: boolean): Buffer {
  const u16 = (n: number) => {
    const bytes = Buffer.alloc(2);
    if (isLittle) bytes.writeUInt16LE(n);
    else bytes.writeUInt16BE(n);
    return bytes;
  };
  const u32 = (n: number) => {
    const bytes = Buffer.alloc(4);
    if (isLittle) bytes.writeUInt32LE(n);
    else bytes.writeUInt32BE(n);
    return bytes;
  };
  const directory = (fields: Fields, start: number) => {
    const entries = Object.entries(fields).sort(([a], [b]) => tags[a as keyof Fields] - tags[b as keyof Fields]);
    let extra = Buffer.alloc(0);
    const after = start + 2 + 12 * entries.length + 4;
    const list = entries.map(([name, value]) => {
      const tag = u16(tags[name as keyof Fields]);
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

/** A segment of a JPEG. */
export function segment(marker: number, content: Uint8Array): Uint8Array {
  const head = Buffer.from([0xff, marker, 0, 0]);
  head.writeUInt16BE(content.length + 2, 2);
  return Buffer.concat([head, content]);
}

/** The segment of EXIF data. */
export const exifSegment = (exif: Buffer) => segment(0xe1, Buffer.concat([Buffer.from("Exif\0\0", "latin1"), exif]));

/** A JPEG with EXIF data after its first marker. */
export const withExif = (jpeg: Uint8Array, exif: Buffer): Uint8Array =>
  Buffer.concat([jpeg.subarray(0, 2), exifSegment(exif), jpeg.subarray(2)]);
