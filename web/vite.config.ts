import { svelte } from "@sveltejs/vite-plugin-svelte";
import { defineConfig } from "vite";

export default defineConfig({
  plugins: [svelte()],
  build: { target: "es2023", chunkSizeWarningLimit: 900 },
  // While pages are being written: the program answers beside them.
  server: { proxy: { "/api": process.env.SPINELINE_SERVER ?? "http://127.0.0.1:8765" } },
});
