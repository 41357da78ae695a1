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
    private readonly child: ChildProcess,
    readonly url: string,
  ) {}

  static async start(program: string, folder: string): Promise<RedisServer> {
    const port = await freePort();
    const child = spawn(program, [
      ...["--port", `${port}`, "--bind", "127.0.0.1", "--dir", folder],
      ...["--save", "", "--appendonly", "yes"],
    ]);
    let log = "";
    for await (const line of createInterface({ input: child.stdout })) {
      log += `${line}\n`;
      if (/ready to accept connections/i.test(line)) {
        // Else it would wait for somebody to read.
        child.stdout.resume();
        return new RedisServer(child, `redis://127.0.0.1:${port}`);
      }
    }
    throw new Error(`Redis did not start:\n${log}`);
  }

  async stop(): Promise<void> {
    this.child.kill();
    if (this.child.exitCode === null) await once(this.child, "exit");
  }
}
