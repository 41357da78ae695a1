/** A Redis server of a test's own. */
import { type ChildProcess, spawn } from "node:child_process";
import { once } from "node:events";
import { createServer, type Server } from "node:net";
import { createInterface } from "node:readline";

/** A port that nobody listens on. */
async function freePort(): Promise<number> {
  const server: Server = createServer().listen(0, "127.0.0.1");
  await once(server, "listening");
  const address = server.address();
  server.close();
  await once(server, "close");
  return address !== null && typeof address === "object" ? address.port : 0;
}

/** A server on a port of the loopback interface, which keeps its data in a folder and logs every write there. */
export class RedisServer {
  private constructor(
    private readonly program: string,
    private readonly folder: string,
    private readonly port: number,
    private child: ChildProcess,
  ) {}

  get url(): string {
    return `redis://127.0.0.1:${this.port}`;
  }

  static async start(program: string, folder: string): Promise<RedisServer> {
    const port = await freePort();
    return new RedisServer(program, folder, port, await RedisServer.#spawned(program, folder, port));
  }

  static async #spawned(program: string, folder: string, port: number): Promise<ChildProcess> {
    const child = spawn(program, [
      ...["--port", `${port}`, "--bind", "127.0.0.1", "--dir", folder],
      ...["--save", "", "--appendonly", "yes", "--appendfsync", "always"],
    ]);
    let log = "";
    for await (const line of createInterface({ input: child.stdout })) {
      log += `${line}\n`;
      if (/ready to accept connections/i.test(line)) {
        // Else it would wait for somebody to read.
        child.stdout.resume();
        return child;
      }
    }
    throw new Error(`Redis did not start:\n${log}`);
  }

  async stop(signal: NodeJS.Signals = "SIGTERM"): Promise<void> {
    if (this.child.exitCode !== null || this.child.signalCode !== null) return;
    this.child.kill(signal);
    await once(this.child, "exit");
  }

  /** Starts it again where it was, with what is in its folder. */
  async startAgain(): Promise<void> {
    this.child = await RedisServer.#spawned(this.program, this.folder, this.port);
  }
}
