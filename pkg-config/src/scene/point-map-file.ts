/** A point map in a `.npy` file as depth and camera: the two files of a view that all readers take. */
import { failure } from "../values/error.js";

/** The text before the elements: `{'descr': '<f4', 'fortran_order': False, 'shape': (480, 640, 3), }`. */
const header = /'descr':\s*'([^']+)',\s*'fortran_order':\s*(\w+),\s*'shape':\s*\((?:1,\s*)?(\d+),\s*(\d+),\s*3\)/;

/** The points of a map, x, y, z per pixel. */
interface PointMapFile {
  points: Float32Array | Float64Array;
  width: number;
  height: number;
}

/**
 * Makes a depth map (`.npy`, z of each point) and a camera file of a point map. The camera is fitted to the points, which may
 * be in the frame of OpenCV (x right, y down, z forward) or in that of PyTorch3D (x left, y up, z forward).
 * @param path names the file in errors
 * @throws {@link Sim3AlignError} `CORRUPT_FILE`, `UNSUPPORTED_FORMAT` for other arrays, `INVALID_CAMERA`
 */
export function viewOfPointMap(path: string, bytes: Uint8Array): { depth: Uint8Array; camera: Uint8Array } {
  const map = parsed(path, bytes);
  const { points, width, height } = map;
  const [u, v] = [fitted(map, 0, (i) => i % width), fitted(map, 1, (i) => Math.floor(i / width))];
  // Both axes are turned, or none.
  const side = Math.sign(u.focal);
  const [fx, fy, cx, cy] = [side * u.focal, side * v.focal, u.center, v.center];
  if (!(fx > 0 && fy > 0)) {
    const expected = "points that a pinhole camera sees, with z forward, x right and y down, or x left and y up";
    const remedy = 'Save output["pointmap"] as it is: numpy.save(path, output["pointmap"].cpu().numpy()).';
    throw failure("INVALID_CAMERA", path, `points whose best camera has fx ${fx}, fy ${fy}`, expected, remedy);
  }
  const z = Float32Array.from({ length: width * height }, (_, i) => points[3 * i + 2] as number);
  const camera = JSON.stringify({ fx, fy, cx, cy, width, height });
  return { depth: npy(z, width, height), camera: new TextEncoder().encode(camera) };
}

function parsed(path: string, bytes: Uint8Array): PointMapFile {
  const start = 10 + (bytes[8] ?? 0) + 256 * (bytes[9] ?? 0);
  const text = new TextDecoder("latin1").decode(bytes.subarray(0, start));
  const [, descr = "", order, ...sides] = header.exec(text) ?? [];
  const size = { "<f4": 4, "<f8": 8 }[descr];
  if (!text.startsWith("NUMPY", 1) || bytes[6] !== 1 || size === undefined || order !== "False") {
    const found = /\{.*\}/.exec(text)?.[0] ?? "a file of another kind";
    const remedy = 'numpy.save(path, output["pointmap"].float().cpu().numpy())';
    throw failure("UNSUPPORTED_FORMAT", path, found, "a .npy array of float32, height × width × 3", remedy);
  }
  const [height = 0, width = 0] = sides.map(Number);
  const count = 3 * width * height;
  if (bytes.length < start + size * count || count === 0) {
    const expected = `${size * count} bytes of ${width} × ${height} points`;
    throw failure(
      "CORRUPT_FILE",
      path,
      `${bytes.length - start} bytes`,
      expected,
      "The file is cut off: save it again.",
    );
  }
  // A copy, whose elements are aligned.
  const data = new Uint8Array(bytes.subarray(start, start + size * count)).buffer;
  return { points: size === 4 ? new Float32Array(data) : new Float64Array(data), width, height };
}

/** The focal length and the principal point of an axis: pixel = focal · x / z + center, by least squares. */
function fitted(
  { points }: PointMapFile,
  axis: 0 | 1,
  pixel: (i: number) => number,
): { focal: number; center: number } {
  let [n, sx, sy, sxx, sxy] = [0, 0, 0, 0, 0];
  for (let i = 0; 3 * i < points.length; i++) {
    const z = points[3 * i + 2] as number;
    const x = (points[3 * i + axis] as number) / z;
    if (!(z > 0 && Number.isFinite(x) && Number.isFinite(z))) continue;
    const y = pixel(i);
    n += 1;
    sx += x;
    sy += y;
    sxx += x * x;
    sxy += x * y;
  }
  const focal = (n * sxy - sx * sy) / (n * sxx - sx * sx);
  return { focal, center: (sy - focal * sx) / n };
}

function npy(values: Float32Array, width: number, height: number): Uint8Array {
  const text = `{'descr': '<f4', 'fortran_order': False, 'shape': (${height}, ${width}), }`;
  const padded = `${text.padEnd(Math.ceil((text.length + 11) / 64) * 64 - 11)}\n`;
  const file = new Uint8Array(10 + padded.length + values.byteLength);
  file.set([0x93, 0x4e, 0x55, 0x4d, 0x50, 0x59, 1, 0, padded.length & 255, padded.length >> 8]);
  file.set(new TextEncoder().encode(padded), 10);
  file.set(new Uint8Array(values.buffer), 10 + padded.length);
  return file;
}
