// A module of src/ for Node, which reads no TypeScript, with all that it imports.
import { fileURLToPath } from "node:url";
import { build } from "esbuild";

export async function load(name) {
  const entryPoints = [fileURLToPath(new URL(`../src/${name}.ts`, import.meta.url))];
  const { outputFiles } = await build({ entryPoints, bundle: true, write: false, format: "esm", logLevel: "error" });
  return import(`data:text/javascript;base64,${Buffer.from(outputFiles[0].contents).toString("base64")}`);
}
