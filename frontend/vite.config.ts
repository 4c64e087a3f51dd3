import react from "@vitejs/plugin-react";
import { defineConfig } from "vitest/config";

export default defineConfig({
  plugins: [react()],
  build: {
    outDir: "../backend/flexsid/frontend_dist",
    emptyOutDir: true,
    // The content security policy allows fonts and scripts from our own origin
    // only, so nothing may become a data: address.
    assetsInlineLimit: 0,
    chunkSizeWarningLimit: 1600, // plotly, loaded with the first figure
    license: { fileName: "licenses.md" },
  },
  server: { proxy: { "/api": process.env.FLEXSID_API ?? "http://127.0.0.1:8000" } },
  test: {
    environment: "jsdom",
    setupFiles: "src/test/setup.ts",
    css: false,
    isolate: false,
  },
});
