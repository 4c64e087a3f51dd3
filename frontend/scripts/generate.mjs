// Writes src/api/schema.gen.ts from the OpenAPI description that the API prints
// about itself, or the file that is named. PYTHON is the interpreter that has flexsid.
import { execFileSync } from "node:child_process";
import { existsSync, writeFileSync } from "node:fs";
import openapiTS, { astToString } from "openapi-typescript";

const local = "../.venv/bin/python";
const python = process.env.PYTHON ?? (existsSync(local) ? local : "python3");
const description = execFileSync(python, ["-m", "flexsid.api.schema"], {
  encoding: "utf8",
  maxBuffer: 64e6,
});
const types = astToString(await openapiTS(JSON.parse(description)));
const header = "// Written by `npm run generate` from the API itself; do not edit.\n\n";
const target = process.argv[2] ?? "src/api/schema.gen.ts";
writeFileSync(target, header + types);
console.log(`${target} written`);
