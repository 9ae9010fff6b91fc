// Geometry: of the robot's shapes, and of the glyphs drawn over it.
import {
  BoxGeometry, BufferAttribute, BufferGeometry, CapsuleGeometry, Color, ConeGeometry, CylinderGeometry, Matrix4,
  SphereGeometry, TorusGeometry, Vector3, Box3, Sphere,
} from "three";
import { decoded } from "./codec.ts";
import type { MeshEntry, Shape, Stage } from "./data.ts";
import { creased } from "./normals.ts";

export const matrix = (rows: number[]): Matrix4 => new Matrix4().fromArray(rows).transpose();

const toZ = new Matrix4().makeRotationX(Math.PI / 2);
const upright = <G extends BufferGeometry>(geometry: G): G => geometry.applyMatrix4(toZ) as G;

/** The meshes of the document, decoded when they are first drawn. */
export class Shapes {
  private readonly meshes = new Map<number, BufferGeometry>();
  private readonly holes = new Map<number, Float32Array>();
  private readonly unit = {
    box: new BoxGeometry(1, 1, 1),
    cylinder: upright(new CylinderGeometry(1, 1, 1, 48)),
    sphere: upright(new SphereGeometry(1, 40, 24)),
  };

  constructor(private readonly entries: Stage["meshes"], private readonly data: Uint8Array) {}

  /** The geometry of a shape and its place in the link's frame; null for a kind that is not known. */
  of(shape: Shape): { geometry: BufferGeometry; at: Matrix4 } | null {
    const at = matrix(shape.at);
    const sized = (x: number, y: number, z: number) => at.multiply(new Matrix4().makeScale(x, y, z));
    if (shape.mesh !== undefined) {
      const [x, y, z] = shape.scale ?? [1, 1, 1];
      return { geometry: this.mesh(shape.mesh), at: sized(x, y, z) };
    }
    if (shape.box) return { geometry: this.unit.box, at: sized(shape.box[0], shape.box[1], shape.box[2]) };
    if (shape.cylinder) {
      const [r, l] = shape.cylinder;
      return { geometry: this.unit.cylinder, at: sized(r, r, l) };
    }
    if (shape.sphere) {
      const [r] = shape.sphere;
      return { geometry: this.unit.sphere, at: sized(r, r, r) };
    }
    if (shape.capsule) return { geometry: upright(new CapsuleGeometry(shape.capsule[0], shape.capsule[1], 12, 40)), at };
    return null;
  }

  /** The bounds of a shape in its link's frame, without decoding its mesh. */
  bounds(shape: Shape): Box3 {
    const at = matrix(shape.at);
    const half = (x: number, y: number, z: number) => new Box3(new Vector3(-x, -y, -z), new Vector3(x, y, z));
    if (shape.mesh !== undefined) {
      const { low, high } = this.entries[shape.mesh];
      const scale = new Vector3(...(shape.scale ?? [1, 1, 1]));
      const box = new Box3().setFromPoints([new Vector3(...low).multiply(scale), new Vector3(...high).multiply(scale)]);
      return box.applyMatrix4(at);
    }
    const [r = 0, l = 0] = shape.cylinder ?? shape.capsule ?? shape.sphere ?? [];
    if (shape.box) return half(shape.box[0] / 2, shape.box[1] / 2, shape.box[2] / 2).applyMatrix4(at);
    if (shape.cylinder) return half(r, r, l / 2).applyMatrix4(at);
    return half(r, r, r + l / 2).applyMatrix4(at);
  }

  /** The ends of a mesh's open edges, in the units of the mesh. */
  edges(mesh: number): Float32Array {
    this.mesh(mesh);
    return this.holes.get(mesh)!;
  }

  hasHoles(mesh: number): boolean {
    return this.entries[mesh].holes > 0;
  }

  private mesh(index: number): BufferGeometry {
    const known = this.meshes.get(index);
    if (known) return known;
    const entry: MeshEntry = this.entries[index];
    const { points, faces, holes } = decoded(this.data, entry);
    const surface = creased(points, faces);
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new BufferAttribute(surface.points, 3));
    const normals = new BufferAttribute(surface.normals, 4, true);
    geometry.setAttribute("normal", normals);
    geometry.setIndex(new BufferAttribute(surface.faces, 1));
    geometry.boundingBox = new Box3(new Vector3(...entry.low), new Vector3(...entry.high));
    geometry.boundingSphere = geometry.boundingBox.getBoundingSphere(new Sphere());
    this.meshes.set(index, geometry);
    this.holes.set(index, holes);
    return geometry;
  }
}

type Piece = { geometry: BufferGeometry; at?: Matrix4; color?: Color };

/** One geometry of several, each in its colour. */
export function joined(pieces: Piece[]): BufferGeometry {
  const positions: number[] = [];
  const normals: number[] = [];
  const colors: number[] = [];
  for (const { geometry, at, color = new Color(1, 1, 1) } of pieces) {
    const flat = geometry.index ? geometry.toNonIndexed() : geometry.clone();
    if (at) flat.applyMatrix4(at);
    positions.push(...flat.attributes.position.array);
    normals.push(...flat.attributes.normal.array);
    for (let i = 0; i < flat.attributes.position.count; i++) colors.push(color.r, color.g, color.b);
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(new Float32Array(positions), 3));
  geometry.setAttribute("normal", new BufferAttribute(new Float32Array(normals), 3));
  geometry.setAttribute("color", new BufferAttribute(new Float32Array(colors), 3));
  return geometry;
}

/** Segments (x y z of one end, of the other, …) as prisms: the corners on their ends, and which way each lies from there. */
function prisms(ends: ArrayLike<number>, sides: number): { corners: Float32Array; offsets: Float32Array } {
  const count = 6 * sides * Math.floor(ends.length / 6);
  const corners = new Float32Array(3 * count);
  const offsets = new Float32Array(3 * count);
  const from = new Vector3(), to = new Vector3(), along = new Vector3(), u = new Vector3(), v = new Vector3();
  let next = 0;
  const corner = (end: Vector3, k: number) => {
    const angle = (2 * Math.PI * k) / sides;
    const c = Math.cos(angle), s = Math.sin(angle);
    end.toArray(corners, next);
    offsets.set([c * u.x + s * v.x, c * u.y + s * v.y, c * u.z + s * v.z], next);
    next += 3;
  };
  for (let i = 0; i + 5 < ends.length; i += 6) {
    from.set(ends[i], ends[i + 1], ends[i + 2]);
    to.set(ends[i + 3], ends[i + 4], ends[i + 5]);
    along.subVectors(to, from).normalize();
    u.set(Math.abs(along.z) < 0.9 ? 0 : 1, 0, Math.abs(along.z) < 0.9 ? 1 : 0).cross(along).normalize();
    v.crossVectors(along, u);
    for (let k = 0; k < sides; k++) {
      corner(from, k); corner(to, k); corner(to, k + 1);
      corner(from, k); corner(to, k + 1); corner(from, k + 1);
    }
  }
  return { corners, offsets };
}

/** Segments as bars of this radius. */
export function tubes(ends: ArrayLike<number>, radius: number, sides = 4): BufferGeometry {
  const { corners, offsets } = prisms(ends, sides);
  const positions = corners.map((value, i) => value + radius * offsets[i]);
  return new BufferGeometry().setAttribute("position", new BufferAttribute(positions, 3));
}

/** Segments for `materials.stroke`, which gives them their width on the screen. */
export function strokes(ends: ArrayLike<number>): BufferGeometry {
  const { corners, offsets } = prisms(ends, 4);
  return new BufferGeometry()
    .setAttribute("position", new BufferAttribute(corners, 3))
    .setAttribute("offset", new BufferAttribute(offsets, 3));
}

/** The segments of a dashed line between two points. */
export function dashes(from: Vector3, to: Vector3, count = 9): number[] {
  const ends: number[] = [];
  for (let i = 0; i < count; i++) {
    const a = from.clone().lerp(to, (2 * i) / (2 * count - 1));
    const b = from.clone().lerp(to, (2 * i + 1) / (2 * count - 1));
    ends.push(...a.toArray(), ...b.toArray());
  }
  return ends;
}

/** The surface between the first of these points and all others. */
export function fan(points: Vector3[]): BufferGeometry {
  const flat: number[] = [];
  for (let i = 1; i + 1 < points.length; i++) {
    for (const point of [points[0], points[i], points[i + 1]]) flat.push(...point.toArray());
  }
  return new BufferGeometry().setAttribute("position", new BufferAttribute(new Float32Array(flat), 3));
}

/** The twelve edges of the box with these edge lengths around the origin. */
export function boxEdges([x, y, z]: number[]): number[] {
  const ends: number[] = [];
  for (const [a, b] of [[-1, -1], [-1, 1], [1, -1], [1, 1]]) {
    ends.push(-x / 2, (a * y) / 2, (b * z) / 2, x / 2, (a * y) / 2, (b * z) / 2);
    ends.push((a * x) / 2, -y / 2, (b * z) / 2, (a * x) / 2, y / 2, (b * z) / 2);
    ends.push((a * x) / 2, (b * y) / 2, -z / 2, (a * x) / 2, (b * y) / 2, z / 2);
  }
  return ends;
}

/** A box that has come apart: its two halves are shifted, and their edges end where it broke. */
export function brokenBox(size: number): number[] {
  const ends: number[] = [];
  const edges = boxEdges([size, size, size]);
  const half = (side: number) => {
    const shift = new Vector3(side * 0.16, side * 0.04, side * 0.12).multiplyScalar(size);
    for (let i = 0; i < edges.length; i += 6) {
      const a = new Vector3().fromArray(edges, i), b = new Vector3().fromArray(edges, i + 3);
      if (a.x * side < 0 && b.x * side < 0) continue;
      // An edge across the crack ends at a zigzag, the other way round on each corner.
      const crack = size * 0.09 * Math.sign(a.y) * Math.sign(a.z);
      if (a.x * side < 0) a.x = crack;
      if (b.x * side < 0) b.x = crack;
      ends.push(...a.add(shift).toArray(), ...b.add(shift).toArray());
    }
    for (const [y, z, y2, z2] of [[-1, -1, -1, 1], [-1, 1, 1, 1], [1, 1, 1, -1], [1, -1, -1, -1]]) {
      const at = (yy: number, zz: number) => new Vector3(size * 0.09 * yy * zz, (yy * size) / 2, (zz * size) / 2).add(shift);
      ends.push(...at(y, z).toArray(), ...at(y2, z2).toArray());
    }
  };
  half(-1);
  half(1);
  return ends;
}

/** A circle of this radius in the plane across z, in segments. */
export function circle(radius: number, count = 48): number[] {
  const ends: number[] = [];
  for (let i = 0; i < count; i++) {
    for (const k of [i, i + 1]) {
      const angle = (2 * Math.PI * k) / count;
      ends.push(radius * Math.cos(angle), radius * Math.sin(angle), 0);
    }
  }
  return ends;
}

const RGB = [new Color(0xe5322d), new Color(0x27a844), new Color(0x2f6fed)];
export const AXIS_COLORS = ["#e5322d", "#27a844", "#2f6fed"];

/** Three cylinders of length 1 along x (red), y (green) and z (blue). */
export function triad(thickness = 0.034): BufferGeometry {
  const bar = upright(new CylinderGeometry(thickness, thickness, 1, 12)).translate(0, 0, 0.5);
  const turns = [new Matrix4().makeRotationY(Math.PI / 2), new Matrix4().makeRotationX(-Math.PI / 2), new Matrix4()];
  return joined(turns.map((at, i) => ({ geometry: bar, at, color: RGB[i] })));
}

/** A ball of radius 1, its octants black and white in turn. */
export function quarteredBall(): BufferGeometry {
  const ball = new SphereGeometry(1, 32, 16).toNonIndexed();
  const { array, count } = ball.attributes.position;
  const colors = new Float32Array(3 * count);
  for (let i = 0; i < count; i += 3) {
    const middle = [0, 1, 2].map((axis) => array[3 * i + axis] + array[3 * i + 3 + axis] + array[3 * i + 6 + axis]);
    colors.fill(middle[0] * middle[1] * middle[2] > 0 ? 0.02 : 1, 3 * i, 3 * i + 9);
  }
  ball.setAttribute("color", new BufferAttribute(colors, 3));
  return ball;
}

/** An arrow of length 1 along z; with `turning`, a curved arrow around it in the sense of a right hand. */
export function axisArrow(turning: boolean): BufferGeometry {
  const shaft = upright(new CylinderGeometry(0.03, 0.03, 1.5, 12)).translate(0, 0, 0.05);
  const tip = upright(new ConeGeometry(0.09, 0.24, 20)).translate(0, 0, 0.9);
  const pieces: Piece[] = [{ geometry: shaft }, { geometry: tip }];
  if (turning) {
    const sweep = 1.55 * Math.PI;
    const ring = new TorusGeometry(0.34, 0.026, 8, 40, sweep).translate(0, 0, 0.3);
    const head = new ConeGeometry(0.085, 0.2, 16)
      .translate(0, 0.06, 0).translate(0.34, 0, 0).applyMatrix4(new Matrix4().makeRotationZ(sweep)).translate(0, 0, 0.3);
    pieces.push({ geometry: ring }, { geometry: head });
  } else {
    const back = upright(new ConeGeometry(0.09, 0.24, 20)).rotateX(Math.PI).translate(0, 0, -0.8);
    pieces.push({ geometry: back });
  }
  return joined(pieces);
}
