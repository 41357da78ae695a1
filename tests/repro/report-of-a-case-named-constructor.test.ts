/** A case whose name is that of a property of every object had neither numbers nor pictures in a report (1.0.0). */
import assert from "node:assert/strict";
import { join } from "node:path";
import { test } from "node:test";
import { files, read, succeeds, writeCase } from "../support/command-line.js";

test("a case named constructor has its row and its pictures", () => {
  writeCase("constructor", files);
  succeeds("align constructor --quality fast --report report");
  const page = read(join("report", "index.html"));
  assert.match(page, /<th scope=row>constructor<td data-key="0\.\d+"/);
  assert.match(page, /<img src="cases\/constructor\/overlay\.png"/);
});
