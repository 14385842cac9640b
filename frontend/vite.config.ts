import { fileURLToPath } from 'node:url'
import { defineConfig } from 'vitest/config'

const built = fileURLToPath(new URL('../backend/treestroke/api/page', import.meta.url))
const pages = ['index', 'share'].map(name => fileURLToPath(new URL(`${name}.html`, import.meta.url)))

// The page lies where the service finds it; nothing is inlined, so that the Content-Security-Policy can be strict.
export default defineConfig({
  base: '/page/',
  build: {
    outDir: built,
    emptyOutDir: true,
    assetsInlineLimit: 0,
    modulePreload: { polyfill: false },
    target: 'es2022',
    chunkSizeWarningLimit: 700, // three.js is one file
    rolldownOptions: {
      input: pages,
      output: {
        codeSplitting: { groups: [{ name: 'three', test: /node_modules[\\/]three[\\/](?!.*meshopt)/ }] },
      },
    },
  },
  server: {
    fs: { allow: ['..'] },
    proxy: { '/v1': process.env.TREESTROKE_AT ?? 'http://127.0.0.1:8000' },
  },
  test: { include: ['test/**/*.test.{ts,tsx}'] },
})
