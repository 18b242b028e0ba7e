// Unpacks npm's Chromium on machines without one, and prints its path and the folder of its libraries.
import { mkdirSync } from "node:fs";
import { join } from "node:path";

// It unpacks into the folder for temporary files; a separate one keeps it for the next run.
const folder = join(import.meta.dirname, "node_modules/.chromium");
mkdirSync(folder, { recursive: true });
process.env.TMPDIR = folder;
// Makes it unpack the libraries that a machine without a desktop lacks.
process.env.AWS_LAMBDA_JS_RUNTIME = "nodejs22.x";

const { default: chromium } = await import("@sparticuz/chromium");
const path = await chromium.executablePath();
process.stdout.write(`${path}\n${process.env.LD_LIBRARY_PATH ?? ""}\n`);
