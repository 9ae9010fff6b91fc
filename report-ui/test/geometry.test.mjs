import assert from "node:assert/strict";
import { test } from "node:test";
import { load } from "./load.mjs";

const { creased } = await load("normals");
const { decoded } = await load("codec");

test("a mesh is read plane by plane", () => {
  // Corners 0 0 0, 16383 0 0, 0 16383 0; a triangle 0 1 2; an edge from the first to the second.
  const steps = [[0, 16383, -16383], [0, 0, 16383], [0, 0, 0]];
  const planes = (values) => {
    const coded = values.map((v) => (v << 1) ^ (v >> 31));
    return [...coded.map((v) => v & 255), ...coded.map((v) => v >> 8)];
  };
  const bytes = [...steps.flatMap(planes), ...planes([0]), ...planes([1]), ...planes([2])];
  bytes.push(0, 0, 0, 0, 0, 0, 0xff, 0x3f, 0, 0, 0, 0);
  const mesh = { offset: 0, vertices: 3, faces: 1, holes: 1, low: [0, 0, 5], high: [2, 4, 5], wide: false };
  const { points, faces, holes } = decoded(Uint8Array.from(bytes), mesh);
  assert.deepEqual([...points], [0, 0, 5, 2, 0, 5, 0, 4, 5]);
  assert.deepEqual([...faces], [0, 1, 2]);
  assert.deepEqual([...holes], [0, 0, 5, 2, 0, 5]);
});

/** A prism with n sides, its corners shared. */
function prism(n) {
  const points = [];
  const faces = [];
  for (let i = 0; i < n; i++) {
    const angle = (2 * Math.PI * i) / n;
    points.push(Math.cos(angle), Math.sin(angle), 0, Math.cos(angle), Math.sin(angle), 1);
    const [a, b, c, d] = [2 * i, 2 * i + 1, (2 * i + 2) % (2 * n), (2 * i + 3) % (2 * n)];
    faces.push(a, c, d, a, d, b);
  }
  return [new Float32Array(points), new Uint32Array(faces)];
}

test("round surfaces share their normals, edges do not", () => {
  assert.equal(creased(...prism(48)).points.length / 3, 96);
  assert.equal(creased(...prism(4)).points.length / 3, 16);
});

test("normals point away from a round surface", () => {
  const { points, normals } = creased(...prism(48));
  for (let i = 0; i < points.length / 3; i++) {
    const along = (points[3 * i] * normals[4 * i] + points[3 * i + 1] * normals[4 * i + 1]) / 127;
    assert.ok(along > 0.98, `corner ${i}: ${along}`);
  }
});
