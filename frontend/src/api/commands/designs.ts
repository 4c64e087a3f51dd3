/** Makes excitation designs, and flies them beforehand. */
import { useMutation, useQueryClient } from "@tanstack/react-query";
import { api, body, json } from "../client";
import type { Design, DesignRequest } from "../types";

export function useRescaleDesign(id: number) {
  const cache = useQueryClient();
  return useMutation({
    mutationFn: (wanted: { name: string; gains: Record<string, number>; note: string }) =>
      body(
        api.POST("/api/v1/designs/{design_id}/rescaled", {
          params: { path: { design_id: id } },
          body: wanted,
        }),
      ),
    onSuccess: () => cache.invalidateQueries({ queryKey: ["designs"], exact: true }),
  });
}

/** Begins a search for phases; the task tells when the design is kept. */
export function useSearchDesign() {
  return useMutation({
    mutationFn: (wanted: DesignRequest) =>
      body(api.POST("/api/v1/designs/searches", { body: wanted })),
  });
}

export function useRedesign(id: number) {
  return useMutation({
    mutationFn: (name: string) =>
      body(
        api.POST("/api/v1/designs/{design_id}/redesign", {
          params: { path: { design_id: id } },
          body: { name, effort: "thorough" },
        }),
      ),
  });
}

export function useRehearse(designId: number) {
  return useMutation({
    mutationFn: (wanted: { run_id: number; level: number; controller_id: number | null }) =>
      body(
        api.POST("/api/v1/designs/{design_id}/rehearsals", {
          params: { path: { design_id: designId } },
          body: wanted,
        }),
      ),
  });
}

interface FlownFiles {
  files: File[];
  name: string;
  rate: number;
  unit: string;
  apart: boolean;
}

export function useImportFlown() {
  const cache = useQueryClient();
  return useMutation({
    mutationFn: async ({ files, name, rate, unit, apart }: FlownFiles) => {
      const form = new FormData();
      for (const file of files) form.append("files", file);
      form.append("name", name);
      form.append("rate_hz", String(rate));
      form.append("unit", unit);
      form.append("apart", String(apart));
      const kept = (await json("/api/v1/designs/flown", { method: "POST", body: form })) as {
        items: Design[];
      };
      return kept.items;
    },
    onSuccess: () => cache.invalidateQueries({ queryKey: ["designs"], exact: true }),
  });
}
