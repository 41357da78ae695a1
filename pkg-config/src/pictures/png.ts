/** PNG files. */
import { promisify } from "node:util";
import { deflate } from "node:zlib";

const compressed = promisify(deflate);

/** An image: 3 or 4 bytes per pixel, row by row: red, green, blue and, of four, alpha. */
export interface Picture {
  data: Uint8Array;
  width: number;
  height: number;
}

/** The checksums of the bytes; zlib's own is missing from older versions of Node. */
const checks = Uint32Array.from({ length: 256 }, (_, byte) => {
  let crc = byte;
  for (let bit = 0; bit < 8; bit++) crc = (crc >>> 1) ^ (crc & 1 ? 0xedb88320 : 0);
  return crc;
});

function crc32(bytes: Uint8Array): number {
  let crc = 0xffffffff;
  for (const byte of bytes) crc = (crc >>> 8) ^ (checks[(crc ^ byte) & 255] as number);
  return (crc ^ 0xffffffff) >>> 0;
}

/** A picture as an 8-bit PNG: RGB or, with four bytes per pixel, RGBA. */
export async function pngOf({ data, width, height }: Picture): Promise<Uint8Array> {
  const channels = data.length / (width * height);
  const header = Buffer.alloc(13);
  header.writeUInt32BE(width, 0);
  header.writeUInt32BE(height, 4);
  header.set([8, channels === 4 ? 6 : 2], 8);
  const pixels = await compressed(filtered(data, channels, width, height), { level: 3 });
  const software = Buffer.from("Software\0sim3align", "latin1");
  const chunks = [
    ...[chunk("IHDR", header), chunk("tEXt", software)],
    ...[chunk("IDAT", pixels), chunk("IEND", Buffer.alloc(0))],
  ];
  return Buffer.concat([Buffer.from("\x89PNG\r\n\x1a\n", "latin1"), ...chunks]);
}

function chunk(type: string, content: Uint8Array): Uint8Array {
  const typed = Buffer.concat([Buffer.from(type, "latin1"), content]);
  const [length, check] = [Buffer.alloc(4), Buffer.alloc(4)];
  length.writeUInt32BE(content.length);
  check.writeUInt32BE(crc32(typed));
  return Buffer.concat([length, typed, check]);
}

/** The rows, each after its filter: the differences from the pixels to the left, of which smaller files are made. */
function filtered(data: Uint8Array, channels: number, width: number, height: number): Uint8Array {
  const stride = channels * width;
  const rows = new Uint8Array(height * (1 + stride));
  for (let v = 0; v < height; v++) {
    const [from, to] = [v * stride, v * (1 + stride)];
    rows[to] = 1;
    for (let x = 0; x < stride; x++)
      rows[to + 1 + x] = (data[from + x] as number) - (x < channels ? 0 : (data[from + x - channels] as number));
  }
  return rows;
}
