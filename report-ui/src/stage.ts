// Where the robot stands: renderer, cameras, light, ground; a picture is made only when something changed.
import {
  Box3, BufferAttribute, BufferGeometry, Color, DirectionalLight, Group, HemisphereLight, LineBasicMaterial, LineSegments, Matrix4, Mesh,
  MeshBasicMaterial, OrthographicCamera, PerspectiveCamera, Quaternion, Scene, Vector2, Vector3, WebGLRenderer, Raycaster,
  PlaneGeometry, MOUSE, TOUCH,
} from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { ORDER, paint, pixel } from "./materials.ts";
import { Outline } from "./outline.ts";
import { length } from "./words.ts";
import type { Theme } from "./theme.ts";

const ANGLE = 32;
const HALF = Math.tan((ANGLE * Math.PI) / 360);
const FLIGHT = 600;
// After so many milliseconds without a change a picture is worth more work.
const REST = 350;
// As high as a key goes: straight above, no direction is up.
const STEEP = 1.55;
// More than so many would keep a processor busy for a second.
const MOST_PIXELS = 6e6;
// What a processor draws a second time without a delay.
const MANY_TRIANGLES = 100_000;

/** From where: `direction` points from the target to the eye. */
export interface View {
  target: Vector3;
  direction: Vector3;
  distance: number;
}

export const DIRECTIONS: Record<string, [number, number, number]> = {
  iso: [1, -0.95, 0.62],
  front: [1, 0, 0.0001],
  left: [0, 1, 0.0001],
  top: [-0.0005, 0, 1],
};

export class Stage {
  readonly scene = new Scene();
  readonly canvas: HTMLCanvasElement;
  readonly software: boolean;
  readonly outline: Outline;
  onRender: () => void = () => {};
  onResize: () => void = () => {};
  /** The height of what covers the top of the picture, in pixels: the robot stands below it. */
  inset = 0;
  /** Whether a person has turned or moved the view. */
  touched = false;
  /** How long one cell of the grid is, in words. */
  cell = "";
  private readonly renderer: WebGLRenderer;
  private readonly perspective = new PerspectiveCamera(ANGLE, 1, 0.01, 100);
  private readonly orthographic = new OrthographicCamera(-1, 1, 1, -1);
  private readonly controls: OrbitControls;
  private readonly ground = new Group();
  private readonly light = { sky: new HemisphereLight(), key: new DirectionalLight(), fill: new DirectionalLight() };
  private size = 1;
  private pending = 0;
  private rest = 0;
  private flight = 0;
  private readonly seen = new Matrix4();
  private width = 1;
  private height = 1;

  /** :throws where there is no WebGL. */
  constructor(private readonly holder: HTMLElement) {
    this.software = softwareRendered();
    this.renderer = new WebGLRenderer({ antialias: !this.software, powerPreference: "high-performance" });
    this.outline = new Outline(this.software);
    this.canvas = this.renderer.domElement;
    this.canvas.tabIndex = 0;
    // The keys are for the picture, not for a screen reader that goes through the page.
    this.canvas.setAttribute("role", "application");
    this.canvas.setAttribute("aria-roledescription", "3D view");
    holder.prepend(this.canvas);
    for (const camera of [this.perspective, this.orthographic]) camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.perspective, this.canvas);
    this.controls.zoomToCursor = true;
    this.controls.mouseButtons = { LEFT: MOUSE.ROTATE, MIDDLE: MOUSE.PAN, RIGHT: MOUSE.PAN };
    this.controls.touches = { ONE: TOUCH.ROTATE, TWO: TOUCH.DOLLY_PAN };
    // A finger that goes up or down scrolls the page.
    this.canvas.style.touchAction = "pan-y";
    this.controls.addEventListener("change", () => this.request());
    this.controls.addEventListener("start", () => {
      this.touched = true;
      this.land();
    });
    const { sky, key, fill } = this.light;
    sky.position.set(0, 0, 1);
    this.scene.add(sky, key, key.target, fill, fill.target, this.ground, this.outline.mesh, clearing());
    new ResizeObserver(() => this.resize()).observe(holder);
    this.resize();
  }

  get camera(): PerspectiveCamera | OrthographicCamera {
    return this.controls.object as PerspectiveCamera | OrthographicCamera;
  }

  get parallel(): boolean {
    return this.camera === this.orthographic;
  }

  resize(): void {
    const { clientWidth, clientHeight } = this.holder;
    if (!clientWidth || !clientHeight || (clientWidth === this.width && clientHeight === this.height)) return;
    this.width = clientWidth;
    this.height = clientHeight;
    this.renderer.setSize(clientWidth, clientHeight, false);
    this.apply(this.view());
    this.onResize();
    this.render();
  }

  paint(theme: Theme): void {
    this.scene.background = theme.page;
    const { sky, key, fill } = this.light;
    sky.color.set(theme.dark ? 0xdfe8f5 : 0xffffff);
    sky.groundColor.set(theme.dark ? 0x3a4048 : 0x9aa0a8);
    sky.intensity = theme.dark ? 1.05 : 1.3;
    key.intensity = theme.dark ? 1.7 : 1.55;
    fill.intensity = theme.dark ? 0.45 : 0.35;
    paint(theme);
    this.outline.paint(theme);
    this.lay(theme);
  }

  /** The robot's place: the ground at its foot, the cells of the grid in proportion to it. */
  fit(box: Box3, height: number, theme: Theme): void {
    this.size = Math.max(box.getSize(new Vector3()).length(), 1e-3);
    this.extent = { box, height };
    this.lay(theme);
  }

  private extent: { box: Box3; height: number } | null = null;

  private lay(theme: Theme): void {
    this.ground.clear();
    if (!this.extent) return;
    const { box, height } = this.extent;
    const cell = round(this.size / 9);
    this.cell = length(cell);
    const middle = box.getCenter(new Vector3());
    const reach = 14;
    const x0 = Math.round(middle.x / cell), y0 = Math.round(middle.y / cell);
    const positions: number[] = [];
    const colors: number[] = [];
    const red = new Color(0xd8453f), green = new Color(0x2e9e4d);
    const point = (i: number, j: number, color: Color, weight: number) => {
      positions.push((x0 + i) * cell, (y0 + j) * cell, height);
      colors.push(color.r, color.g, color.b, weight * Math.max(0, 1 - Math.hypot(i, j) / reach) ** 1.3);
    };
    for (let i = -reach; i <= reach; i++) {
      const tenth = (k: number) => (k % 5 === 0 ? 1 : 0.55);
      for (let j = -reach; j < reach; j++) {
        if (Math.hypot(i, j + 0.5) > reach) continue;
        const onY = x0 + i === 0, onX = y0 + i === 0;
        point(i, j, onY ? green : theme.soft, onY ? 0.9 : tenth(x0 + i) * 0.55);
        point(i, j + 1, onY ? green : theme.soft, onY ? 0.9 : tenth(x0 + i) * 0.55);
        point(j, i, onX ? red : theme.soft, onX ? 0.9 : tenth(y0 + i) * 0.55);
        point(j + 1, i, onX ? red : theme.soft, onX ? 0.9 : tenth(y0 + i) * 0.55);
      }
    }
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new BufferAttribute(new Float32Array(positions), 3));
    geometry.setAttribute("color", new BufferAttribute(new Float32Array(colors), 4));
    const grid = new LineSegments(geometry, new LineBasicMaterial({ vertexColors: true, transparent: true, depthWrite: false }));
    this.ground.add(grid);
  }

  view(): View {
    const eye = this.camera.position.clone().sub(this.controls.target);
    const seen = this.parallel ? this.orthographic.top / this.orthographic.zoom / HALF : eye.length();
    return { target: this.controls.target.clone(), direction: eye.normalize(), distance: seen || 1 };
  }

  /** Moves both cameras: what they show at the target has one size. */
  private apply({ target, direction, distance }: View): void {
    const ratio = this.width / this.height;
    this.controls.target.copy(target);
    this.perspective.aspect = ratio;
    this.perspective.position.copy(target).addScaledVector(direction, distance);
    const half = distance * HALF;
    Object.assign(this.orthographic, { top: half, bottom: -half, left: -half * ratio, right: half * ratio, zoom: 1 });
    this.orthographic.position.copy(target).addScaledVector(direction, distance + 4 * this.size);
    for (const camera of [this.perspective, this.orthographic]) {
      camera.lookAt(target);
      camera.setViewOffset(this.width, this.height, 0, -this.inset / 2, this.width, this.height);
    }
  }

  /** The view along `direction` that holds a box; `room` is the part of the picture's edge that stays free. */
  around(box: Box3, direction: Vector3, room: number): View {
    const target = box.getCenter(new Vector3());
    const eye = direction.clone().normalize();
    const turn = new Quaternion().setFromRotationMatrix(
      new PerspectiveCamera().matrix.lookAt(eye, new Vector3(), new Vector3(0, 0, 1)),
    ).invert();
    const free = (this.height - this.inset) / this.height;
    const ratio = this.width / this.height;
    let distance = 1e-3;
    for (let i = 0; i < 8; i++) {
      const corner = new Vector3(
        i & 1 ? box.max.x : box.min.x, i & 2 ? box.max.y : box.min.y, i & 4 ? box.max.z : box.min.z,
      ).sub(target).applyQuaternion(turn);
      const across = Math.max(Math.abs(corner.x) / ratio, Math.abs(corner.y) / free) / (HALF * (1 - room));
      distance = Math.max(distance, across + corner.z);
    }
    return { target, direction: eye, distance };
  }

  /** Flies to a view, or is there at once where motion is not wanted. */
  fly(to: View, atOnce = false): void {
    this.land();
    const from = this.view();
    const still = atOnce || matchMedia("(prefers-reduced-motion: reduce)").matches;
    document.body.dataset.fly = "1";
    const arrive = () => {
      this.apply(to);
      this.controls.update();
      this.flight = 0;
      this.render();
      document.body.dataset.fly = "0";
    };
    if (still) return arrive();
    const polar = ({ direction: { x, y, z } }: View) => [Math.atan2(y, x), Math.asin(Math.max(-1, Math.min(1, z)))];
    const [a0, e0] = polar(from);
    const [a1, e1] = polar(to);
    const turn = Math.atan2(Math.sin(a1 - a0), Math.cos(a1 - a0));
    const began = performance.now();
    const step = (now: number) => {
      const t = Math.min(1, Math.max(0, (now - began) / FLIGHT));
      if (t === 1) return arrive();
      const k = t < 0.5 ? 4 * t ** 3 : 1 - (-2 * t + 2) ** 3 / 2;
      const azimuth = a0 + k * turn, elevation = e0 + k * (e1 - e0);
      this.apply({
        target: from.target.clone().lerp(to.target, k),
        direction: new Vector3(
          Math.cos(azimuth) * Math.cos(elevation), Math.sin(azimuth) * Math.cos(elevation), Math.sin(elevation),
        ),
        distance: from.distance * (to.distance / from.distance) ** k,
      });
      this.render();
      this.flight = requestAnimationFrame(step);
    };
    this.flight = requestAnimationFrame(step);
  }

  /** A hand on the camera ends a flight. */
  private land(): void {
    if (!this.flight) return;
    cancelAnimationFrame(this.flight);
    this.flight = 0;
    document.body.dataset.fly = "0";
  }

  /** Goes around the target by angles: to the right, and up. */
  orbit(across: number, up: number): void {
    const view = this.view();
    const { x, y, z } = view.direction;
    const azimuth = Math.atan2(y, x) + across;
    const elevation = Math.max(-STEEP, Math.min(STEEP, Math.asin(Math.max(-1, Math.min(1, z))) + up));
    view.direction.set(Math.cos(azimuth) * Math.cos(elevation), Math.sin(azimuth) * Math.cos(elevation), Math.sin(elevation));
    this.steer(view);
  }

  /** Moves what is seen by parts of the picture's height. */
  pan(across: number, up: number): void {
    const view = this.view();
    const shift = new Vector3(across, up, 0).multiplyScalar(2 * HALF * view.distance).applyQuaternion(this.camera.quaternion);
    view.target.add(shift);
    this.steer(view);
  }

  /** Changes the distance by a factor. */
  zoom(factor: number): void {
    const view = this.view();
    view.distance *= factor;
    this.steer(view);
  }

  private steer(view: View): void {
    this.land();
    this.touched = true;
    this.apply(view);
    this.controls.update();
    this.request();
  }

  project(parallel: boolean): void {
    const view = this.view();
    this.controls.object = parallel ? this.orthographic : this.perspective;
    this.apply(view);
    this.controls.update();
    this.request();
  }

  request(): void {
    this.pending ||= requestAnimationFrame(() => this.render());
  }

  render(): void {
    cancelAnimationFrame(this.pending);
    this.pending = 0;
    this.draw(1);
    if (this.software) {
      clearTimeout(this.rest);
      this.rest = window.setTimeout(() => this.draw(2), REST);
    }
  }

  /** A picture; without a graphics card its edges are smoothed by more pixels, once nothing moves. */
  private draw(sharp: 1 | 2): void {
    const many = 4 * this.width * this.height > MOST_PIXELS;
    const ratio = !this.software ? Math.min(devicePixelRatio, 2) : many ? 1 : sharp;
    if (this.renderer.getPixelRatio() !== ratio) this.renderer.setPixelRatio(ratio);
    const { camera } = this;
    const distance = camera.position.distanceTo(this.controls.target);
    camera.near = this.parallel ? 0 : Math.max(distance / 400, this.size * 1e-4);
    camera.far = distance + 12 * this.size;
    const { top, bottom, zoom } = this.orthographic;
    pixel.value = (this.parallel ? (top - bottom) / zoom : 2 * HALF) / this.height;
    camera.updateProjectionMatrix();
    camera.updateMatrixWorld();
    // Light from over the shoulder: no side of the robot is ever dark.
    const { key, fill } = this.light;
    const { target } = this.controls;
    const from = (x: number, y: number, z: number) => new Vector3(x, y, z).applyQuaternion(camera.quaternion);
    key.target.position.copy(target);
    fill.target.position.copy(target);
    key.position.copy(target).add(from(-0.45, 0.75, 0.9).multiplyScalar(this.size)).add(new Vector3(0, 0, 0.4 * this.size));
    fill.position.copy(target).add(from(0.9, -0.1, 0.3).multiplyScalar(this.size));
    // What moves has to be quick: of many triangles no outline is drawn on the way, unless there is a graphics card.
    const isLate = this.software && sharp === 1 && this.outline.weight > MANY_TRIANGLES && !this.isStill();
    const { mesh } = this.outline;
    const { visible } = mesh;
    if (isLate) mesh.visible = false;
    this.outline.draw(this.renderer, this.scene, camera, ratio);
    this.renderer.render(this.scene, camera);
    mesh.visible = visible;
    this.onRender();
  }

  /** Whether the camera is where it was for the last picture. */
  private isStill(): boolean {
    const { matrixWorld } = this.camera;
    const still = matrixWorld.equals(this.seen);
    this.seen.copy(matrixWorld);
    return still;
  }

  /** The picture as a PNG, on `background` if one is given. */
  picture(background?: Color): string {
    const before = this.scene.background;
    if (background) this.scene.background = background;
    this.draw(2);
    const url = this.canvas.toDataURL("image/png");
    this.scene.background = before;
    if (background) this.render();
    return url;
  }

  /** The link of the first of `targets` under a point of the window. */
  pick(x: number, y: number, targets: Mesh[]): string | null {
    const rect = this.canvas.getBoundingClientRect();
    const at = new Vector2(((x - rect.left) / rect.width) * 2 - 1, 1 - ((y - rect.top) / rect.height) * 2);
    const ray = new Raycaster();
    ray.setFromCamera(at, this.camera);
    const [hit] = ray.intersectObjects(targets, false);
    return hit ? (hit.object.userData.link as string) : null;
  }

  get bounds(): { width: number; height: number } {
    return { width: this.width, height: this.height };
  }

  onLost(lost: () => void): void {
    this.canvas.addEventListener("webglcontextlost", lost);
  }
}

/** Rounded to 1, 2 or 5 times a power of ten. */
function round(value: number): number {
  const power = 10 ** Math.floor(Math.log10(value));
  const digit = value / power;
  return power * (digit < 1.5 ? 1 : digit < 3.5 ? 2 : digit < 7.5 ? 5 : 10);
}

/** Glyphs are drawn after this, over the robot but with depth among themselves. */
function clearing(): Mesh {
  const mesh = new Mesh(new PlaneGeometry(1e-6, 1e-6), new MeshBasicMaterial({ colorWrite: false, depthWrite: false, transparent: true }));
  mesh.renderOrder = ORDER.clear;
  mesh.frustumCulled = false;
  mesh.onBeforeRender = (renderer) => renderer.clearDepth();
  return mesh;
}

/** Whether pictures are computed without a graphics card; such a one is asked for less. */
function softwareRendered(): boolean {
  const gl = document.createElement("canvas").getContext("webgl2");
  if (!gl) throw new Error("this browser offers no WebGL 2");
  const info = gl.getExtension("WEBGL_debug_renderer_info");
  const name = String(gl.getParameter(info ? info.UNMASKED_RENDERER_WEBGL : gl.RENDERER));
  gl.getExtension("WEBGL_lose_context")?.loseContext();
  return /SwiftShader|llvmpipe|Software/i.test(name);
}
