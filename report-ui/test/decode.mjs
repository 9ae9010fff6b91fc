// Reads {mesh, text} as JSON and writes what the page would decode, for the test that compares it with what was packed.
import { text } from "node:stream/consumers";
import { load } from "./load.mjs";

const { decoded, inflated } = await load("codec");
const given = JSON.parse(await text(process.stdin));
const { points, faces, holes } = decoded(await inflated(given.text), given.mesh);
console.log(JSON.stringify({ points: [...points], faces: [...faces], holes: [...holes] }));
