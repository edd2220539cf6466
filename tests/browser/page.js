// Draws a slice of a decoded codestream, and checks all golden ones.

import { bytesOf, verdict } from "./check.js";
import { Decoder } from "./decoder.js";

const element = (id) => document.getElementById(id);
const FIRST = "linear_brick_crop";

/** The codestream shown, and its samples at the level of the slider. */
const shown = { bytes: new Uint8Array(), extent: [1, 1, 1], samples: new Int32Array(1) };

let decoder;

/** Shows another codestream, or what is wrong with it. */
function show(bytes) {
    shown.bytes = bytes;
    try {
        const header = decoder.header(bytes);
        element("level").max = header.levels;
        element("level").value = 0;
        const transform = header.wavelet === "none" ? header.storage : `${header.storage}, ${header.wavelet}`;
        const bits = (8 * bytes.length) / header.extent.reduce((product, axis) => product * axis);
        element("about").textContent =
            `${header.extent.join(" × ")} samples of type ${header.sampleType}, ${transform}, ` +
            `${header.levels} levels: ${bytes.length} bytes, ${bits.toFixed(2)} bits per sample`;
        decodeLevel();
    } catch (error) {
        fault(error);
    }
}

/** Decodes the level of the slider. */
function decodeLevel() {
    try {
        const level = Number(element("level").value);
        const { bytes } = decoder.level(shown.bytes, level);
        Object.assign(shown, decoder.decode(shown.bytes, level));
        element("level-text").textContent = `${level}: ${bytes} B`;
        element("slice").max = shown.extent[2] - 1;
        element("slice").value = shown.extent[2] >> 1;
        element("about").className = "";
        draw();
    } catch (error) {
        fault(error);
    }
}

/** Draws the slice of the slider, its darkest sample of all black and its lightest white. */
function draw() {
    const [width, height, depth] = shown.extent;
    const z = Number(element("slice").value);
    element("slice-text").textContent = `${z + 1} of ${depth}`;
    const canvas = element("picture");
    canvas.width = width;
    canvas.height = height;
    let [low, high] = [Infinity, -Infinity];
    for (const sample of shown.samples) {
        low = Math.min(low, sample);
        high = Math.max(high, sample);
    }
    const picture = new ImageData(width, height);
    const slice = shown.samples.subarray(z * width * height, (z + 1) * width * height);
    slice.forEach((sample, i) => {
        const grey = (255 * (sample - low)) / (high - low || 1);
        picture.data.set([grey, grey, grey, 255], 4 * i);
    });
    canvas.getContext("2d").putImageData(picture, 0, 0);
}

function fault(error) {
    element("about").textContent = error.message;
    element("about").className = "fault";
    element("picture").width = 1;
}

async function fetched(path) {
    const response = await fetch(path);
    if (!response.ok) {
        throw new Error(`${path}: ${response.status}`);
    }
    return response;
}

async function start() {
    decoder = await Decoder.load(await (await fetched("wavelift.wasm")).arrayBuffer());
    const vectors = await (await fetched("vectors.json")).json();
    for (const { id } of vectors) {
        element("vector").add(new Option(id, id, id === FIRST, id === FIRST));
    }
    const byId = (wanted) => vectors.find(({ id }) => id === wanted);
    element("vector").onchange = (event) => show(bytesOf(byId(event.target.value)));
    element("file").onchange = async (event) => show(new Uint8Array(await event.target.files[0].arrayBuffer()));
    element("level").oninput = decodeLevel;
    element("slice").oninput = draw;
    show(bytesOf(byId(FIRST)));
    return verdict(decoder, vectors);
}

const text = await start().catch((error) => `0 passed, 1 failed\n${error}`);
element("verdict").textContent = text;
// Who checks the page without looking at it opens it with `?verdict`, and is told.
if (location.search === "?verdict") {
    await fetch("verdict", { method: "POST", body: text });
}
