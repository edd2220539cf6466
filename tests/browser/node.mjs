// The check in Node: node node.mjs, in the folder where the module and the list of vectors are.

import { readFile } from "node:fs/promises";

import { verdict } from "./check.js";
import { Decoder } from "./decoder.js";

const decoder = await Decoder.load(await readFile("wavelift.wasm"));
const vectors = JSON.parse(await readFile("vectors.json", "utf8"));
const found = verdict(decoder, vectors);
console.log(found);
process.exitCode = found.endsWith(" 0 failed") && vectors.length > 0 ? 0 : 1;
