// The page of the panel, as the extension makes it of a report: node test/make_page.mjs REPORT PAGE
import { readFile, writeFile } from "node:fs/promises";
import { build } from "esbuild";

const own = (name) => new URL(`../${name}`, import.meta.url);
const entryPoints = [own("src/report.ts").pathname];
const { outputFiles } = await build({ entryPoints, bundle: true, write: false, platform: "node", format: "esm" });
const { makePage } = await import(`data:text/javascript;base64,${Buffer.from(outputFiles[0].text).toString("base64")}`);
const [report, script, style] = await Promise.all(
  [process.argv[2], own("dist/follow.js"), own("dist/panel.css")].map((file) => readFile(file, "utf8")),
);
await writeFile(process.argv[3], makePage(report, script, style));
