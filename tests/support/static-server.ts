/** The static server of the scripts. */
import { join } from "node:path";
import { pathToFileURL } from "node:url";
import { repository } from "./environment.js";

/** A running server. */
export interface Server {
  url: string;
  close(): Promise<void>;
}

/** Serves a folder. */
export async function serve(folder: string): Promise<Server> {
  const module = pathToFileURL(join(repository, "scripts", "lib", "static-server.mjs")).href;
  const { serve } = (await import(module)) as { serve(folder: string): Promise<Server> };
  return serve(folder);
}
