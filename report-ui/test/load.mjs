// A module of src/ for Node, which reads no TypeScript.
import { readFile } from "node:fs/promises";
import { transform } from "esbuild";

export async function load(name) {
  const source = await readFile(new URL(`../src/${name}.ts`, import.meta.url), "utf8");
  const { code } = await transform(source, { loader: "ts" });
  return import(`data:text/javascript,${encodeURIComponent(code)}`);
}
