import { join } from "node:path";
import { pathToFileURL } from "node:url";
import { repository } from "./environment.js";

/** A running server. */
export interface Server {
  url: string;
  close(): Promise<void>;
}

/** Serves a folder. */
export const serve = async (folder: string): Promise<Server> =>
  (await import(pathToFileURL(join(repository, "scripts", "lib", "static-server.mjs")).href)).serve(folder);
