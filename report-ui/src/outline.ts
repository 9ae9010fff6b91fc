// Outlines of links: what stands out keeps the colours of its material.
import {
  AdditiveBlending, BufferAttribute, BufferGeometry, type Camera, Color, DoubleSide, LinearFilter, Mesh, MeshBasicMaterial,
  NearestFilter, type Scene, ShaderMaterial, Vector2, Vector3, Vector4, type WebGLRenderer, WebGLRenderTarget,
} from "three";
import { ORDER } from "./materials.ts";
import type { Theme } from "./theme.ts";

/** What a line can say. A mask has a channel for each. */
export const LINES = ["error", "warning", "other"] as const;
export type Line = (typeof LINES)[number];

/** As they are on the screen, light and dark. `other`: what a repair would make of it. */
export const LINE_COLORS: Record<Line, [string, string]> = {
  error: ["#d4281e", "#ff7a6e"], warning: ["#c77700", "#ffb52e"], other: ["#0d8f4f", "#4fd68c"],
};

/** In pixels of the page. Errors differ from warnings without colours too. */
const WIDTHS: Record<Line, number> = { error: 3, warning: 2, other: 2 };
// Only the camera of the mask sees this layer.
const MASK = 1;

const CHANNELS: Record<Line, number> = { error: 0xff0000, warning: 0x00ff00, other: 0x0000ff };
const covered = (color: number) => new MeshBasicMaterial({ color, side: DoubleSide });
/** Seen through everything, and without a loss for what is before it. */
const through = (color: number) =>
  new MeshBasicMaterial({ color, side: DoubleSide, blending: AdditiveBlending, depthTest: false, depthWrite: false, transparent: true });
const masks = new Map<string, MeshBasicMaterial>();

export interface Outlined {
  mesh: Mesh;
  /** Null where the mesh only hides what is behind it. */
  line: Line | null;
  /** Whether nothing hides it. */
  isThrough?: boolean;
}

function maskOf({ line, isThrough = false }: Outlined): MeshBasicMaterial {
  const key = `${line} ${isThrough}`;
  const color = line ? CHANNELS[line] : 0;
  const mask = masks.get(key) ?? (isThrough ? through(color) : covered(color));
  masks.set(key, mask);
  return mask;
}

/** A mask of the meshes in the colours above, and a rectangle over the picture that draws the edges of the mask. */
export class Outline {
  /** A part of the scene: glyphs are drawn over it. */
  readonly mesh: Mesh<BufferGeometry, ShaderMaterial>;
  private readonly target: WebGLRenderTarget;
  private items: Outlined[] = [];
  /** What the mask was drawn from. */
  private drawn: Float64Array = new Float64Array();

  /** `software`: there is no graphics card, so edges are not smoothed. */
  constructor(software: boolean) {
    const filter = software ? NearestFilter : LinearFilter;
    this.target = new WebGLRenderTarget(1, 1, { samples: software ? 0 : 4, minFilter: filter, magFilter: filter });
    const corners = new Float32Array([0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 0, 0, 1, 1, 0, 0, 1, 0]);
    const geometry = new BufferGeometry().setAttribute("position", new BufferAttribute(corners, 3));
    const uniforms = {
      mask: { value: this.target.texture }, texel: { value: new Vector2() }, part: { value: new Vector4() },
      colors: { value: LINES.map(() => new Color()) }, errors: { value: false },
    };
    this.mesh = new Mesh(geometry, new ShaderMaterial({
      uniforms, vertexShader: VERTEX, fragmentShader: FRAGMENT, transparent: true, depthTest: false, depthWrite: false,
    }));
    this.mesh.renderOrder = ORDER.outline;
    this.mesh.frustumCulled = false;
    this.mesh.visible = false;
  }

  show(items: Outlined[]): void {
    for (const { mesh } of this.items) mesh.layers.disable(MASK);
    this.items = items;
    for (const { mesh } of items) mesh.layers.enable(MASK);
    this.mesh.visible = items.some(({ line }) => line !== null);
    this.mesh.material.uniforms.errors!.value = items.some(({ line }) => line === "error");
  }

  paint(theme: Theme): void {
    const colors = this.mesh.material.uniforms.colors!.value as Color[];
    // The shader writes what the screen shows: no conversion to linear light.
    LINES.forEach((line, i) => colors[i]!.setStyle(LINE_COLORS[line][theme.dark ? 1 : 0], ""));
  }

  /** How many triangles a mask has. */
  get weight(): number {
    return this.items.reduce((sum, { mesh }) => sum + (mesh.geometry.index?.count ?? 0) / 3, 0);
  }

  /** Draws the mask for the picture that comes next; `ratio`: pixels of the device per pixel of the page. */
  draw(renderer: WebGLRenderer, scene: Scene, camera: Camera, ratio: number): void {
    if (!this.mesh.visible) return;
    const { width, height } = renderer.domElement;
    const { texel, part } = this.mesh.material.uniforms;
    const now = this.signature(camera);
    // The mask of a finer picture is good enough: a colour under the mouse changes nothing of it.
    const isKnown = this.target.width >= width && now.length === this.drawn.length && now.every((value, i) => value === this.drawn[i]);
    if (!isKnown) {
      this.drawn = now;
      this.target.setSize(width, height);
    }
    this.target.scissorTest = true;
    (texel!.value as Vector2).set(ratio / width, ratio / height);
    const [left, bottom, right, top] = this.bounds(camera);
    // The lines are around the bounds, and are found by what is around them.
    const [x, y] = [(2 * WIDTHS.error * ratio) / width, (2 * WIDTHS.error * ratio) / height];
    (part!.value as Vector4).set(left - x / 2, bottom - y / 2, right - left + x, top - bottom + y);
    if (isKnown) return;
    this.target.scissor.set((left - x) * width, (bottom - y) * height, (right - left + 2 * x) * width, (top - bottom + 2 * y) * height).round();
    const { background } = scene;
    const dressed = this.items.map(({ mesh }) => mesh.material);
    scene.background = null;
    camera.layers.set(MASK);
    for (const item of this.items) item.mesh.material = maskOf(item);
    renderer.setRenderTarget(this.target);
    renderer.render(scene, camera);
    renderer.setRenderTarget(null);
    this.items.forEach(({ mesh }, i) => { mesh.material = dressed[i]!; });
    camera.layers.set(0);
    scene.background = background;
  }

  private signature(camera: Camera): Float64Array {
    const codes = this.items.flatMap(({ mesh, line, isThrough }) => [mesh.id, line ? LINES.indexOf(line) : -1, Number(isThrough ?? false)]);
    const places = [camera, ...this.items.map(({ mesh }) => mesh)].map((object) => object.matrixWorld.elements);
    return Float64Array.from([...codes, ...camera.projectionMatrix.elements, ...places.flat()]);
  }

  /** The part of the picture that holds what has a line, from 0 to 1: left, bottom, right, top. */
  private bounds(camera: Camera): [number, number, number, number] {
    let [left, bottom, right, top] = [1, 1, 0, 0];
    const at = new Vector3();
    for (const { mesh, line } of this.items) {
      if (!line) continue;
      if (!mesh.geometry.boundingBox) mesh.geometry.computeBoundingBox();
      const { min, max } = mesh.geometry.boundingBox!;
      for (let i = 0; i < 8; i++) {
        at.set(i & 1 ? max.x : min.x, i & 2 ? max.y : min.y, i & 4 ? max.z : min.z).applyMatrix4(mesh.matrixWorld);
        at.applyMatrix4(camera.matrixWorldInverse);
        // What is beside or behind the eye may be anywhere.
        if (at.z > -1e-9) return [0, 0, 1, 1];
        at.applyMatrix4(camera.projectionMatrix);
        left = Math.min(left, (at.x + 1) / 2);
        right = Math.max(right, (at.x + 1) / 2);
        bottom = Math.min(bottom, (at.y + 1) / 2);
        top = Math.max(top, (at.y + 1) / 2);
      }
    }
    return [Math.max(left, 0), Math.max(bottom, 0), Math.min(right, 1), Math.min(top, 1)];
  }
}

const VERTEX = `
uniform vec4 part;
varying vec2 at;
void main() {
  at = part.xy + part.zw * position.xy;
  gl_Position = vec4(2.0 * at - 1.0, 0.0, 1.0);
}`;

// A line lies around its links, and an error over a warning. A ring of samples finds what is near; half as far as the line is
// wide it has no gaps.
const FRAGMENT = `
uniform sampler2D mask;
uniform vec2 texel;
uniform vec3 colors[3];
uniform bool errors;
varying vec2 at;
const vec2 AROUND[8] = vec2[8](vec2(1, 0), vec2(.7071, .7071), vec2(0, 1), vec2(-.7071, .7071), vec2(-1, 0), vec2(-.7071, -.7071), vec2(0, -1), vec2(.7071, -.7071));
vec3 ring(float radius) {
  vec3 most = vec3(0.0);
  for (int i = 0; i < 8; i++) {
    most = max(most, texture2D(mask, at + radius * texel * AROUND[i]).rgb);
  }
  return most;
}
void main() {
  vec3 near = ring(${WIDTHS.warning.toFixed(1)});
  float wide = errors ? ring(${WIDTHS.error.toFixed(1)}).r : 0.0;
  vec3 here = texture2D(mask, at).rgb;
  vec3 edge = vec3(max(near.r, wide), near.gb) * (1.0 - here);
  edge.g *= 1.0 - here.r;
  edge.gb *= 1.0 - edge.r;
  edge.g *= 1.0 - edge.b;
  float alpha = edge.r + edge.g + edge.b;
  if (alpha < 0.02) discard;
  gl_FragColor = vec4((edge.r * colors[0] + edge.g * colors[1] + edge.b * colors[2]) / alpha, min(alpha, 1.0));
}`;
