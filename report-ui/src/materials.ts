// What bodies and glyphs are made of.
import {
  Color, DoubleSide, MeshBasicMaterial, MeshLambertMaterial, MeshPhongMaterial,
} from "three";
import type { Theme } from "./theme.ts";

/** Transparent things are drawn in this order, after everything solid. */
export const ORDER = {
  shade: 0.3, afterDepth: 0.4, after: 0.5, volume: 0.7, collision: 0.8, ghostDepth: 1, ghost: 2, outline: 9, clear: 10, veil: 11, glyph: 12,
} as const;

/** Of two surfaces in one place the one with this is seen. */
export const IN_FRONT = { polygonOffset: true, polygonOffsetFactor: -1, polygonOffsetUnits: -4 };

/** Light that grazes the outline: dark parts stay legible before a dark page. */
function rimmed(material: MeshPhongMaterial): MeshPhongMaterial {
  const rim = { value: new Color() };
  material.userData.rim = rim.value;
  material.onBeforeCompile = (shader) => {
    shader.uniforms.rimColor = rim;
    shader.fragmentShader = shader.fragmentShader
      .replace("void main() {", "uniform vec3 rimColor;\nvoid main() {")
      .replace(
        "#include <opaque_fragment>",
        "outgoingLight += rimColor * pow(1.0 - abs(dot(normal, normalize(vViewPosition))), 2.6);\n#include <opaque_fragment>",
      );
  };
  material.customProgramCacheKey = () => "rim";
  return material;
}

/** The light around a body; `glow`: the colour of its worst finding while it is pointed at. */
export function edge(material: MeshPhongMaterial, theme: Theme, glow: Color | null): void {
  const rim = material.userData.rim as Color;
  if (glow) rim.copy(glow).multiplyScalar(0.85);
  else if (theme.dark) rim.setRGB(0.15, 0.18, 0.23);
  else rim.setRGB(0.07, 0.08, 0.1);
}

export function body(color: Color, alpha: number): MeshPhongMaterial {
  const solid = alpha >= 0.99;
  return rimmed(
    new MeshPhongMaterial({
      color, side: DoubleSide, specular: 0x2a2a2a, shininess: 34,
      transparent: !solid, opacity: alpha, depthWrite: solid,
    }),
  );
}

/** What all models share; `paint` gives them the colours of a theme. */
export const shared = {
  ghost: rimmed(new MeshPhongMaterial({ side: DoubleSide, transparent: true, opacity: 0.16, specular: 0, depthWrite: false })),
  depth: new MeshBasicMaterial({ colorWrite: false, side: DoubleSide, transparent: true }),
  collision: new MeshLambertMaterial({
    color: 0xffbe38, transparent: true, opacity: 0.35, depthWrite: false, side: DoubleSide,
    ...IN_FRONT,
  }),
  collisionGhost: new MeshLambertMaterial({ color: 0xffbe38, transparent: true, opacity: 0.07, depthWrite: false, side: DoubleSide }),
  /** Glyphs with colours of their own; shaded, and transparent only to be drawn late. */
  glyph: new MeshLambertMaterial({ vertexColors: true, transparent: true }),
};

export function paint(theme: Theme): void {
  edge(shared.ghost, theme, null);
  shared.ghost.color.copy(theme.dark ? new Color(0x8a99ab) : new Color(0x77879a));
  shared.ghost.opacity = theme.dark ? 0.15 : 0.17;
}

/** Lines and marks in one colour that light does not change. */
export function mark(color: Color | number, opacity = 1): MeshBasicMaterial {
  return new MeshBasicMaterial({ color, transparent: true, opacity, side: DoubleSide, depthWrite: opacity === 1 });
}

/** How long a pixel is, at a distance of one without perspective: `Stage` sets it for each picture. */
export const pixel = { value: 0 };
const known = new Map<string, MeshBasicMaterial>();

/** Lines (`shapes.strokes`) of so many pixels, however near they are. */
export function stroke(color: Color | number, pixels: number): MeshBasicMaterial {
  const key = `${new Color(color).getHex()} ${pixels}`;
  const found = known.get(key);
  if (found) return found;
  const material = mark(color);
  const width = { value: pixels / 2 };
  material.onBeforeCompile = (shader) => {
    Object.assign(shader.uniforms, { pixel, halfWidth: width });
    shader.vertexShader = shader.vertexShader
      .replace("void main() {", "attribute vec3 offset;\nuniform float pixel, halfWidth;\nvoid main() {")
      .replace(
        "#include <begin_vertex>",
        `#include <begin_vertex>
        float away = isOrthographic ? 1.0 : max(0.0, -(modelViewMatrix * vec4(position, 1.0)).z);
        transformed += offset * halfWidth * pixel * away;`,
      );
  };
  material.customProgramCacheKey = () => "stroke";
  known.set(key, material);
  return material;
}
