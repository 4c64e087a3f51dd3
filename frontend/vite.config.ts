import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { brotliCompressSync, gzipSync } from "node:zlib";
import react from "@vitejs/plugin-react";
import type { Plugin } from "vite";
import { defineConfig } from "vitest/config";

/** Writes assets compressed as well: the server sends the form that the browser accepts. */
const compressAssets: Plugin = {
  name: "compress-assets",
  apply: "build",
  writeBundle({ dir = "" }, bundle) {
    for (const name of Object.keys(bundle)) {
      if (!/^assets\/.*\.(js|css|svg)$/.test(name)) continue;
      const file = join(dir, name);
      const content = readFileSync(file);
      writeFileSync(`${file}.br`, brotliCompressSync(content));
      writeFileSync(`${file}.gz`, gzipSync(content, { level: 9 }));
    }
  },
};

export default defineConfig({
  plugins: [react(), compressAssets],
  build: {
    outDir: "../backend/flexsid/frontend_dist",
    emptyOutDir: true,
    // The content security policy allows fonts and scripts from our own origin
    // only, so nothing may become a data: address.
    assetsInlineLimit: 0,
    chunkSizeWarningLimit: 1600, // plotly, loaded with the first figure
    license: { fileName: "licenses.md" },
    rolldownOptions: {
      output: {
        // Otherwise each set of pages that shares something has a file of its own.
        codeSplitting: {
          groups: [
            { name: "packages", test: /node_modules[\\/](?!plotly|uplot)/, priority: 2 },
            { name: "shared", test: /[\\/]src[\\/]/, minShareCount: 3, priority: 1 },
          ],
        },
      },
    },
  },
  server: { proxy: { "/api": process.env.FLEXSID_API ?? "http://127.0.0.1:8000" } },
  test: {
    environment: "jsdom",
    setupFiles: "src/test/setup.ts",
    css: false,
    isolate: false,
  },
});
