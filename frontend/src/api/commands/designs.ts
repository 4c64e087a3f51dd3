/** Commands on excitation designs and pre-flight simulations. */
import { useMutation, useQueryClient } from "@tanstack/react-query";
import { api, body, json } from "../client";
import type { Design, DesignRequest, PreflightSimulationRequest } from "../types";

export function useRescaleDesign(id: number) {
  const cache = useQueryClient();
  return useMutation({
    mutationFn: (request: { name: string; gains: Record<string, number>; note: string }) =>
      body(
        api.POST("/api/v1/designs/{design_id}/rescaled", {
          params: { path: { design_id: id } },
          body: request,
        }),
      ),
    onSuccess: () => cache.invalidateQueries({ queryKey: ["designs"], exact: true }),
  });
}

/** Requests a phase optimisation; its job ends when the design is stored. */
export function useSearchDesign() {
  return useMutation({
    mutationFn: (request: DesignRequest) =>
      body(api.POST("/api/v1/designs/searches", { body: request })),
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

export function useSimulatePreflight(designId: number) {
  return useMutation({
    mutationFn: (request: PreflightSimulationRequest) =>
      body(
        api.POST("/api/v1/designs/{design_id}/preflight-simulations", {
          params: { path: { design_id: designId } },
          body: request,
        }),
      ),
  });
}

interface FlownFiles {
  files: File[];
  name: string;
  rate: number;
  unit: string;
  separate: boolean;
}

export function useImportFlown() {
  const cache = useQueryClient();
  return useMutation({
    mutationFn: async ({ files, name, rate, unit, separate }: FlownFiles) => {
      const form = new FormData();
      for (const file of files) form.append("files", file);
      form.append("name", name);
      form.append("rate_hz", String(rate));
      form.append("unit", unit);
      form.append("separate", String(separate));
      const stored = (await json("/api/v1/designs/import", { method: "POST", body: form })) as {
        items: Design[];
      };
      return stored.items;
    },
    onSuccess: () => cache.invalidateQueries({ queryKey: ["designs"], exact: true }),
  });
}
