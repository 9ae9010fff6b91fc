// Builds the one script of the report's 3D view: `npm run build`. Equal sources give equal bytes.
import { readFile } from "node:fs/promises";
import { fileURLToPath } from "node:url";
import { build } from "esbuild";

const three = fileURLToPath(new URL("node_modules/three/", import.meta.url));
const licence = (await readFile(`${three}LICENSE`, "utf8")).trim().replaceAll("\u00a9", "(c)");

// What the view never uses, though the renderer holds on to it: headsets, light from pictures of surroundings, shadows, morphing,
// effects, and the shaders of physical materials. A fifth of the script.
const HEADSET = `export class WebXRManager {
  enabled = false; isPresenting = false; cameraAutoUpdate = false;
  addEventListener() {} removeEventListener() {} setAnimationLoop() {} dispose() {} setUserCamera() {}
  getEnvironmentBlendMode() {} getFoveation() {} hasDepthSensing() { return false; }
}`;
const UNUSED = [
  [/WebXRManager\.js$/, HEADSET],
  [/PMREMGenerator\.js$/, "export class PMREMGenerator { dispose() {} }"],
  [/WebGLShadowMap\.js$/, "export class WebGLShadowMap { enabled = false; type = 1; render() {} }"],
  [/WebGLUniformsGroups\.js$/, "export class WebGLUniformsGroups { dispose() {} }"],
  [/WebGLMorphtargets\.js$/, "export class WebGLMorphtargets {}"],
  [/WebGLOutput\.js$/, "export class WebGLOutput {}"],
  [/DFGLUTData\.js$/, "export function getDFGLUT() { return null; }"],
  [/(lights_physical|transmission|iridescence|clearcoat|shadowm|tonemapping_pars|lightprobes|cube_uv|envmap_physical)\w*\.glsl\.js$/, 'export default "";'],
  [/(depth|linedashed|meshphysical|meshtoon|meshmatcap|meshnormal|points|sprite|shadow|vsm|cube|equirect|background\w*|distance\w*)\.glsl\.js$/,
    'export const vertex = "void main() {}", fragment = "void main() {}";'],
];

const slim = {
  name: "slim",
  setup({ onResolve, onLoad }) {
    onResolve({ filter: /^three$/ }, () => ({ path: `${three}src/Three.js`, sideEffects: false }));
    onLoad({ filter: /three.src.*\.js$/ }, async ({ path }) => {
      const unused = UNUSED.find(([name]) => name.test(path));
      if (unused) return { contents: unused[1] };
      if (!path.endsWith(".glsl.js")) return null;
      const shader = await readFile(path, "utf8");
      return { contents: shader.replace(/\/\*[^]*?\*\/|\/\/.*$/gm, "").replace(/^\s+|[ \t]+$/gm, "") };
    });
  },
};

await build({
  entryPoints: [fileURLToPath(new URL("src/main.ts", import.meta.url))],
  outfile: process.argv[2],
  bundle: true,
  minify: true,
  format: "iife",
  target: "es2022",
  charset: "ascii",
  legalComments: "inline",
  banner: { js: `/*! With three.js:\n\n${licence}\n*/` },
  plugins: [slim],
  logLevel: "warning",
});
