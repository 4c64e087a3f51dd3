import "@fontsource-variable/inter/wght.css";
import "@mantine/core/styles.css";
import "./styles.css";
import { MantineProvider } from "@mantine/core";
import { QueryClient, QueryClientProvider } from "@tanstack/react-query";
import { RouterProvider } from "@tanstack/react-router";
import { StrictMode } from "react";
import { createRoot } from "react-dom/client";
import { ApiProblem } from "./api/problem";
import { axesQuery, healthQuery, sessionQuery } from "./api/queries";
import { SessionGate } from "./components/account/SessionGate";
import { colorSchemeManager } from "./lib/figures/colorScheme";
import { setAxes } from "./lib/derivatives";
import { router } from "./routes";
import { theme } from "./theme";

const queries: QueryClient = new QueryClient({
  defaultOptions: {
    // The browser's network state does not apply to a server on this computer, and a
    // paused query would never report a lost server.
    mutations: { networkMode: "always" },
    queries: {
      networkMode: "always",
      staleTime: 10_000,
      // A refused request is not repeated; a lost connection is retried.
      retry: (failures, error) => {
        const lost = !(error instanceof ApiProblem) || error.status === 0;
        if (lost) void queries.invalidateQueries(healthQuery); // so that the frame reports it soon
        return lost && failures < 3;
      },
      retryDelay: (attempt) => Math.min(500 * 2 ** attempt, 4000),
    },
  },
});

const root = document.getElementById("root");
if (root === null) throw new Error("index.html has no element with id root");

queries.query(sessionQuery).catch(() => undefined); // beside the next request, not after it
// Names of derivatives are those of the server.
await queries
  .query(axesQuery)
  .then(setAxes)
  .catch(() => undefined);
createRoot(root).render(
  <StrictMode>
    <MantineProvider
      theme={theme}
      defaultColorScheme="auto"
      colorSchemeManager={colorSchemeManager}
    >
      <QueryClientProvider client={queries}>
        <SessionGate>
          <RouterProvider router={router} />
        </SessionGate>
      </QueryClientProvider>
    </MantineProvider>
  </StrictMode>,
);
