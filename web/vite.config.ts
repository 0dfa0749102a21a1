// How the page is built: into crates/server/page, from where the server embeds it.
import { svelte } from '@sveltejs/vite-plugin-svelte';
import { defineConfig, type Plugin } from 'vite';

// `npm run dev` shows the page against a server that runs already.
const server = process.env.LEADSCREW_URL ?? 'http://127.0.0.1:8383';

/** What the first picture needs is asked for at once, not only when the script that uses it has been read; in one order in each build. */
const early: Plugin = {
  name: 'early',
  transformIndexHtml: {
    order: 'post',
    handler: (_html, { bundle }) => Object.keys(bundle ?? {}).sort().flatMap((file) => {
      const link = (attributes: Record<string, string | boolean>) => ({ tag: 'link', attrs: { ...attributes, crossorigin: true, href: `/${file}` }, injectTo: 'head' as const });
      if (/\/scene-.*\.js$/.test(file)) return [link({ rel: 'modulepreload' })];
      if (/roboto-latin-(400|500)-.*\.woff2$/.test(file)) return [link({ rel: 'preload', as: 'font', type: 'font/woff2' })];
      return [];
    }),
  },
};

export default defineConfig({
  plugins: [svelte(), early],
  build: {
    outDir: '../crates/server/page',
    emptyOutDir: true,
    target: 'es2022',
    // Fonts and pictures stay files: the policy of the page allows no data addresses.
    assetsInlineLimit: 0,
    modulePreload: { polyfill: false },
    chunkSizeWarningLimit: 800,
  },
  server: {
    proxy: {
      '/api': {
        target: server,
        ws: true,
        changeOrigin: true,
        // The server answers pages of its own origin only; this page is served by Vite while one works on it.
        configure: (proxy) => {
          proxy.on('proxyReq', (request) => request.setHeader('origin', server));
          proxy.on('proxyReqWs', (request) => request.setHeader('origin', server));
        },
      },
    },
  },
});
