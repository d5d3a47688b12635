// Runs a program in WebAssembly with arguments.
import { readFile } from "node:fs/promises";
import { WASI } from "node:wasi";

const [file, ...given] = process.argv.slice(2);
const wasi = new WASI({ version: "preview1", args: [file, ...given] });
const { instance } = await WebAssembly.instantiate(await readFile(file), wasi.getImportObject());
wasi.start(instance);
