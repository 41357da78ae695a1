/** Open3D, in a process of its own that answers one request a line. */
import { spawn } from "node:child_process";
import { mkdirSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { createInterface } from "node:readline";
import { at } from "../lib/paths.mjs";
import { pythonEnvironment, pythonVariables } from "./python.mjs";

/** @typedef {import("./case.mjs").TypedCase} TypedCase */
/** @typedef {{ ms: number, stages: Record<string, number>, matrix: number[] }} Answer */
/**
 * Whether RANSAC estimates the scale too, and whether ICP runs on the thinned clouds, for speed, instead of on all points.
 * @typedef {{ withScaling?: boolean, thinned?: boolean }} Variant
 */

/**
 * The environment with Open3D, and its Python.
 * @param {string} program the Python that makes it
 */
export const installOpen3d = (program) =>
  pythonEnvironment("open3d", at("scripts", "bench", "requirements.txt"), program);

/** A process that has imported Open3D. */
export class Open3d {
  #process;
  #lines;
  version = "";

  /** @param {string} python @param {number} threads */
  constructor(python, threads) {
    this.#process = spawn(python, [at("scripts", "bench", "open3d_peer.py")], {
      stdio: ["pipe", "pipe", "inherit"],
      env: { ...process.env, ...pythonVariables, OMP_NUM_THREADS: `${threads}` },
    });
    this.#lines = createInterface({ input: this.#process.stdout })[Symbol.asyncIterator]();
  }

  /** @param {string} python the environment's @param {number} threads */
  static async start(python, threads) {
    const peer = new Open3d(python, threads);
    peer.version = (await peer.#next()).version;
    return peer;
  }

  /**
   * Gives it a case, as files of bare numbers.
   * @param {string} name
   * @param {TypedCase} input
   */
  async load(name, { depth, mask, width, height, camera, mesh }) {
    const folder = at("target", "bench", "inputs");
    mkdirSync(folder, { recursive: true });
    /** @param {string} part @param {ArrayBufferView} numbers */
    const write = (part, { buffer, byteOffset, byteLength }) => {
      const file = join(folder, part);
      writeFileSync(file, new Uint8Array(buffer, byteOffset, byteLength));
      return file;
    };
    const indices = Uint32Array.from(mesh.indices);
    await this.#ask({
      ...{ load: name, width, height, camera },
      ...{ depth: write("depth", depth), mask: write("mask", mask) },
      ...{ positions: write("positions", mesh.positions), indices: write("indices", indices) },
    });
  }

  /**
   * Aligns a case that it was given.
   * @param {string} name
   * @param {Variant} variant
   * @param {number} seed
   * @returns {Promise<Answer>}
   */
  align(name, { withScaling = false, thinned = false }, seed) {
    return this.#ask({ align: name, withScaling, thinned, seed });
  }

  /** Ends the process. */
  stop() {
    this.#process.stdin.end();
  }

  /** @param {object} request */
  async #ask(request) {
    this.#process.stdin.write(`${JSON.stringify(request)}\n`);
    const answer = await this.#next();
    if (answer.error) throw new Error(`Open3D: ${answer.error}`);
    return answer;
  }

  async #next() {
    const { value, done } = await this.#lines.next();
    if (done) throw new Error(`The Python process ended. Remedy: remove target/bench/open3d, and try again.`);
    return JSON.parse(value);
  }
}
