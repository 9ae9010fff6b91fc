// The way back from what urdfcheck/facts/mesh/codec.py packs.
import type { MeshEntry } from "./data.ts";

const STEPS = (1 << 14) - 1;

export interface Decoded {
  /** x y z of each corner. */
  points: Float32Array;
  /** Three corners of each triangle. */
  faces: Uint32Array;
  /** Two ends of each open edge. */
  holes: Float32Array;
}

/** The bytes of base64 of raw deflate. */
export async function inflated(text: string): Promise<Uint8Array> {
  const packed = atob(text.trim());
  const bytes = new Uint8Array(packed.length);
  for (let i = 0; i < bytes.length; i++) bytes[i] = packed.charCodeAt(i);
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate-raw"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

export function decoded(data: Uint8Array, mesh: MeshEntry): Decoded {
  const { vertices: n, faces: m, holes } = mesh;
  const size = mesh.wide ? 3 : 2;
  const step = mesh.low.map((low, i) => (mesh.high[i] - low) / STEPS);
  let at = mesh.offset;

  const points = new Float32Array(3 * n);
  for (let axis = 0; axis < 3; axis++, at += 2 * n) {
    const low = mesh.low[axis];
    const scale = step[axis];
    for (let i = 0, sum = 0, to = axis; i < n; i++, to += 3) {
      const z = data[at + i] | (data[at + n + i] << 8);
      sum += (z >>> 1) ^ -(z & 1);
      points[to] = low + scale * sum;
    }
  }

  const faces = new Uint32Array(3 * m);
  for (let corner = 0; corner < 3; corner++, at += size * m) {
    for (let i = 0, sum = 0, to = corner; i < m; i++, to += 3) {
      let z = data[at + i] | (data[at + m + i] << 8);
      if (size === 3) z |= data[at + 2 * m + i] << 16;
      const difference = (z >>> 1) ^ -(z & 1);
      faces[to] = corner === 0 ? (sum += difference) : faces[to - corner] + difference;
    }
  }

  const ends = new Float32Array(6 * holes);
  for (let i = 0; i < ends.length; i++, at += 2) {
    ends[i] = mesh.low[i % 3] + step[i % 3] * (data[at] | (data[at + 1] << 8));
  }
  return { points, faces, holes: ends };
}
