/** Which methods of other libraries the benchmark runs, and what an answer is expected to take, in seconds. */
import { readdirSync, readFileSync } from "node:fs";
import { join } from "node:path";

/** @type {Record<string, number>} */
const quick = {
  "open3d-fgr": 0.15,
  "open3d-gicp": 0.2,
  "open3d-icp-point-to-plane": 0.3,
  "open3d-icp-point-to-point": 0.3,
  "open3d-ransac": 0.5,
  "open3d-ransac-scale": 0.5,
  "small-gicp": 0.15,
  "kiss-matcher": 0.1,
};

/**
 * Methods that align a mesh.
 * @param {boolean} isQuick
 */
export const meshMethods = (isQuick) => (isQuick ? quick : { ...quick, "probreg-cpd": 4 });

/** Methods that align two clouds. @type {Record<string, number>} */
export const pairMethods = { "open3d-ransac": 2, "open3d-fgr": 1, "kiss-matcher": 0.5 };

/**
 * The libraries' names and versions, as their answers have them.
 * @param {string} answers a folder of methods' folders
 * @returns {Record<string, string>}
 */
export function versionsOf(answers) {
  /** @type {Record<string, string>} */
  const versions = {};
  for (const method of readdirSync(answers)) {
    const [first] = readdirSync(join(answers, method));
    if (first === undefined) continue;
    const { software = "" } = JSON.parse(readFileSync(join(answers, method, first), "utf8"));
    const [name = "", version = ""] = software.split(" ");
    if (version !== "") versions[name] = version;
  }
  return versions;
}
