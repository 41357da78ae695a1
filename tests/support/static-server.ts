import { scriptModule } from "./internals.js";

/** A running server. */
export interface Server {
  url: string;
  close(): Promise<void>;
}

/** Serves a folder. */
export const serve = async (folder: string): Promise<Server> =>
  (await scriptModule("lib/static-server.mjs")).serve(folder);
