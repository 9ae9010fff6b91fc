// Builds the extension and the script and style that it adds to the report: `npm run build`.
import { copyFile } from "node:fs/promises";
import { build } from "esbuild";

const common = { bundle: true, target: "es2022", minify: true, legalComments: "eof", logLevel: "warning" };

await build({
  ...common,
  entryPoints: ["src/extension.ts"],
  outfile: "dist/extension.js",
  platform: "node",
  format: "cjs",
  external: ["vscode"],
});
await build({ ...common, entryPoints: ["src/page/follow.ts", "src/page/panel.css"], outdir: "dist", format: "iife", charset: "ascii" });
await copyFile(new URL("../../LICENSE", import.meta.url), "LICENSE");
