import { svelte } from "@sveltejs/vite-plugin-svelte";
import { defineConfig } from "vitest/config";

export default defineConfig({
  plugins: [svelte()],
  build: { target: "es2023", chunkSizeWarningLimit: 900, license: { fileName: "licences.md" } },
  test: { include: ["src/**/*.test.ts"], setupFiles: ["src/api/page.setup.ts"] },
  // During development the program answers the requests.
  server: { proxy: { "/api": process.env.SPINELINE_SERVER ?? "http://127.0.0.1:8765" } },
});
