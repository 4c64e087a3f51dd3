/** The workbench itself: its health, glossary, figures and saved views. */
import { keepPreviousData, queryOptions } from "@tanstack/react-query";
import { address, api, body, items, json, type QueryValue } from "../client";
import type { DisplayUnits, FigureSpec } from "../types";

const RETRY_MS = 1500;
const WATCH_MS = 10_000;

export const healthQuery = queryOptions({
  queryKey: ["health"],
  queryFn: ({ signal }) => body(api.GET("/api/v1/health", { signal })),
  // The only poll: a server that cannot be reached sends no event, and a connection that is lost
  // without being closed reports no error.
  refetchInterval: ({ state }) => (state.status === "error" ? RETRY_MS : WATCH_MS),
  retry: false,
});

export const meaningQuery = (name: string, units: DisplayUnits) =>
  queryOptions({
    queryKey: ["nomenclature", name, units],
    queryFn: async ({ signal }) => {
      const query = { names: name, ...units };
      const found = await items(api.GET("/api/v1/nomenclature", { params: { query }, signal }));
      return found[0] ?? null;
    },
    staleTime: Infinity,
  });

/** SI units, and Hz, with their display unit. */
export const displayUnitsQuery = (query: DisplayUnits) =>
  queryOptions({
    queryKey: ["nomenclature", "display-units", query],
    queryFn: ({ signal }) =>
      items(api.GET("/api/v1/nomenclature/units", { params: { query }, signal })),
    placeholderData: keepPreviousData,
    staleTime: Infinity,
  });

/** Units of parameters by name; dimensionless parameters are omitted. */
export const unitsQuery = (names: readonly string[]) =>
  queryOptions({
    queryKey: ["nomenclature", "units", names],
    queryFn: async ({ signal }) => {
      const query = { names: names.join(",") };
      const found = await items(api.GET("/api/v1/nomenclature", { params: { query }, signal }));
      return Object.fromEntries<string>(
        found.flatMap(({ unit }, index) => (unit === "1" ? [] : [[names[index] ?? "", unit]])),
      );
    },
    staleTime: Infinity,
    enabled: names.length > 0,
  });

export const glossaryQuery = (query: DisplayUnits) =>
  queryOptions({
    queryKey: ["nomenclature", query],
    queryFn: ({ signal }) => items(api.GET("/api/v1/nomenclature", { params: { query }, signal })),
    staleTime: Infinity,
  });

export const axesQuery = queryOptions({
  queryKey: ["nomenclature", "axes"],
  queryFn: ({ signal }) => items(api.GET("/api/v1/nomenclature/axes", { signal })),
  staleTime: Infinity,
});

export const savedViewsQuery = (page: string) =>
  queryOptions({
    queryKey: ["saved-views", page],
    queryFn: ({ signal }) =>
      items(api.GET("/api/v1/saved-views", { params: { query: { page } }, signal })),
  });

export const figureQuery = (kind: string, params: Record<string, QueryValue>) =>
  queryOptions({
    queryKey: ["figure", kind, params],
    queryFn: ({ signal }) =>
      json(address(`figures/${kind}`, params), { signal }) as Promise<FigureSpec>,
    placeholderData: keepPreviousData,
    staleTime: 60_000,
  });
