// Renders the page on the server, and serves what Vite built: PORT=8080 node server.mjs
import { readFile } from "node:fs/promises";
import { createServer } from "node:http";
import { extname, join, normalize } from "node:path";
import { fileURLToPath } from "node:url";
import { render } from "./dist/server/entry-server.js";

const built = fileURLToPath(new URL("dist", import.meta.url));
const types = { ".html": "text/html; charset=utf-8", ".js": "text/javascript", ".wasm": "application/wasm" };

const server = createServer(async ({ url = "/" }, response) => {
  const { pathname } = new URL(url, "http://localhost");
  try {
    if (pathname === "/") {
      const { html, first } = await render(join(built, "mug"));
      const page = await readFile(join(built, "index.html"), "utf8");
      // Numbers only: nothing in it ends the script.
      const data = `<script type="application/json" id="data">${JSON.stringify(first)}</script>`;
      response.setHeader("content-type", types[".html"]);
      response.end(page.replace("<!--app-->", () => html).replace("</body>", () => `${data}</body>`));
      return;
    }
    const bytes = await readFile(join(built, normalize(pathname)));
    response.setHeader("content-type", types[extname(pathname)] ?? "application/octet-stream");
    response.end(bytes);
  } catch (error) {
    response.statusCode = error.code === "ENOENT" ? 404 : 500;
    response.end(`${error.message}\n`);
  }
});
server.listen(Number(process.env.PORT ?? 8080), "127.0.0.1", () => {
  console.log(`http://127.0.0.1:${server.address().port}/`);
});
