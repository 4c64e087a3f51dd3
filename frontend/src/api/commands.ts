/** What pages change: submit, cancel, import, delete. */
import { useMutation, useQueryClient } from "@tanstack/react-query";
import { api, body, json } from "./client";
import type {
  Controller,
  Action,
  BatchRequest,
  CutRequest,
  StepRequest,
  Design,
  DesignRequest,
  ManyOf,
  ResponsesRequest,
  RunRequest,
  SavedViewRequest,
  SearchRequest,
  StructureFilesRequest,
  StructureEditRequest,
  StructureRequest,
  ThrustRequest,
  UploadDetail,
} from "./types";

/** Everything that shows a run: its own page, lists, and the badges of the campaign. */
const RUN_VIEWS = [
  ...[["runs"], ["run"], ["jobs"], ["job"], ["maneuvers"]],
  ...[["batches"], ["batch"], ["queue"]],
];

function useRefreshRuns() {
  const cache = useQueryClient();
  return () => Promise.all(RUN_VIEWS.map((queryKey) => cache.invalidateQueries({ queryKey })));
}

export function useSubmitRuns() {
  return useMutation({
    mutationFn: (requests: RunRequest[]) =>
      Promise.all(requests.map((request) => body(api.POST("/api/v1/runs", { body: request })))),
    onSettled: useRefreshRuns(),
  });
}

export function useSubmitBatch() {
  return useMutation({
    mutationFn: (request: BatchRequest) => body(api.POST("/api/v1/batches", { body: request })),
    onSettled: useRefreshRuns(),
  });
}

/** Cancels what has not ended of a batch, or asks again for what failed. */
export function useChangeBatch(id: number, action: "cancel" | "retry") {
  const path = { batch_id: id };
  return useMutation({
    mutationFn: () =>
      action === "cancel"
        ? body(api.POST("/api/v1/batches/{batch_id}/cancel", { params: { path } }))
        : body(api.POST("/api/v1/batches/{batch_id}/retry", { params: { path } })),
    onSettled: useRefreshRuns(),
  });
}

export function useRetryJob() {
  return useMutation({
    mutationFn: (id: number) =>
      body(api.POST("/api/v1/jobs/{job_id}/retry", { params: { path: { job_id: id } } })),
    onSettled: useRefreshRuns(),
  });
}

export function useCancelJob() {
  return useMutation({
    mutationFn: (id: number) =>
      body(api.POST("/api/v1/jobs/{job_id}/cancel", { params: { path: { job_id: id } } })),
    onSettled: useRefreshRuns(),
  });
}

export function useDeleteRun() {
  return useMutation({
    mutationFn: (id: number) =>
      body(api.DELETE("/api/v1/runs/{run_id}", { params: { path: { run_id: id } } })),
    onSuccess: useRefreshRuns(),
  });
}

/** Deletes, restores, tags or untags many; the answer says which were changed. */
export function useChangeMany(what: ManyOf) {
  const cache = useQueryClient();
  return useMutation({
    mutationFn: (wanted: { ids: number[]; action: Action; tag?: string }) =>
      what === "runs"
        ? body(api.POST("/api/v1/runs/changes", { body: wanted }))
        : body(api.POST("/api/v1/maneuvers/changes", { body: wanted })),
    onSettled: () => {
      // Not waited for: what can be undone is told at once, lists follow.
      for (const key of [...RUN_VIEWS, ["maneuver"], ["ground-tests"], ["figure", "envelope"]]) {
        void cache.invalidateQueries({ queryKey: key });
      }
    },
  });
}

export function useSaveView() {
  const cache = useQueryClient();
  return useMutation({
    mutationFn: (wanted: SavedViewRequest) =>
      body(api.POST("/api/v1/saved-views", { body: wanted })),
    onSuccess: () => cache.invalidateQueries({ queryKey: ["saved-views"] }),
  });
}

export function useForgetView() {
  const cache = useQueryClient();
  return useMutation({
    mutationFn: (id: number) =>
      body(api.DELETE("/api/v1/saved-views/{view_id}", { params: { path: { view_id: id } } })),
    onSettled: () => cache.invalidateQueries({ queryKey: ["saved-views"] }),
  });
}

export function useUploadFiles() {
  return useMutation({
    mutationFn: (files: File[]) => {
      const form = new FormData();
      for (const file of files) form.append("files", file);
      return json("/api/v1/uploads", { method: "POST", body: form }) as Promise<UploadDetail>;
    },
  });
}

export function useImportUpload(id: string) {
  const cache = useQueryClient();
  return useMutation({
    mutationFn: (mapping: string) =>
      body(
        api.POST("/api/v1/uploads/{upload_id}/import", {
          params: { path: { upload_id: id } },
          body: { mapping },
        }),
      ),
    onSuccess: (begun) => {
      cache.setQueryData(["upload", id, "state"], begun);
    },
  });
}

/** Cancels an import that goes on; else the files are forgotten. */
export function useForgetUpload(id: string) {
  const cache = useQueryClient();
  return useMutation({
    mutationFn: () =>
      body(api.DELETE("/api/v1/uploads/{upload_id}", { params: { path: { upload_id: id } } })),
    onSettled: () => cache.invalidateQueries({ queryKey: ["upload", id, "state"] }),
  });
}

export function useKeepMapping() {
  const cache = useQueryClient();
  return useMutation({
    mutationFn: (wanted: { name: string; text: string }) =>
      body(api.POST("/api/v1/mappings", { body: { ...wanted, note: "" } })),
    onSuccess: () => cache.invalidateQueries({ queryKey: ["mappings"] }),
  });
}

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

interface GivenController {
  aircraft: number;
  name: string;
  text: string;
  file: File | null;
  reads: string;
  drives: string;
}

export function useSetThrust() {
  const cache = useQueryClient();
  return useMutation({
    mutationFn: ({ id, table }: { id: number; table: ThrustRequest }) =>
      body(
        api.PUT("/api/v1/aircraft/{aircraft_id}/thrust", {
          params: { path: { aircraft_id: id } },
          body: table,
        }),
      ),
    onSuccess: () => cache.invalidateQueries({ queryKey: ["aircraft"] }),
  });
}

export function useRemoveThrust() {
  const cache = useQueryClient();
  return useMutation({
    mutationFn: (id: number) =>
      body(
        api.DELETE("/api/v1/aircraft/{aircraft_id}/thrust", {
          params: { path: { aircraft_id: id } },
        }),
      ),
    onSuccess: () => cache.invalidateQueries({ queryKey: ["aircraft"] }),
  });
}

export function useKeepController() {
  const cache = useQueryClient();
  return useMutation({
    mutationFn: ({ aircraft, name, text, file, reads, drives }: GivenController) => {
      if (file === null) {
        return body(
          api.POST("/api/v1/controllers", { body: { aircraft_id: aircraft, name, text } }),
        );
      }
      const form = new FormData();
      form.append("file", file);
      form.append("aircraft_id", String(aircraft));
      form.append("name", name);
      form.append("reads", reads);
      form.append("drives", drives);
      return json("/api/v1/controllers/files", {
        method: "POST",
        body: form,
      }) as Promise<Controller>;
    },
    onSuccess: () => cache.invalidateQueries({ queryKey: ["controllers"] }),
  });
}

export function useCancelTask() {
  const cache = useQueryClient();
  return useMutation({
    mutationFn: (id: string) =>
      body(api.POST("/api/v1/tasks/{task_id}/cancel", { params: { path: { task_id: id } } })),
    onSettled: () => cache.invalidateQueries({ queryKey: ["task"] }),
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

export function useRequestSearch() {
  const cache = useQueryClient();
  return useMutation({
    mutationFn: (wanted: SearchRequest) => body(api.POST("/api/v1/searches", { body: wanted })),
    onSuccess: () => cache.invalidateQueries({ queryKey: ["searches"] }),
  });
}

export function useCancelSearch() {
  const cache = useQueryClient();
  return useMutation({
    mutationFn: (id: number) =>
      body(
        api.POST("/api/v1/searches/{search_id}/cancel", { params: { path: { search_id: id } } }),
      ),
    onSettled: () => cache.invalidateQueries({ queryKey: ["searches"] }),
  });
}

/** Opens a candidate of a search as a run; the same run every time. */
export function useOpenCandidate(id: number) {
  const cache = useQueryClient();
  const refresh = useRefreshRuns();
  return useMutation({
    mutationFn: (place: number) =>
      body(
        api.POST("/api/v1/searches/{search_id}/candidates/{place}/run", {
          params: { path: { search_id: id, place } },
        }),
      ),
    onSuccess: () =>
      Promise.all([cache.invalidateQueries({ queryKey: ["searches", id] }), refresh()]),
  });
}

export function useAddStructure() {
  const cache = useQueryClient();
  return useMutation({
    mutationFn: (wanted: StructureRequest) =>
      body(api.POST("/api/v1/model-structures", { body: wanted })),
    onSuccess: () => cache.invalidateQueries({ queryKey: ["structures"] }),
  });
}

export function useEditStructure(id: number) {
  const cache = useQueryClient();
  return useMutation({
    mutationFn: (wanted: StructureEditRequest) =>
      body(
        api.PUT("/api/v1/model-structures/{structure_id}", {
          params: { path: { structure_id: id } },
          body: wanted,
        }),
      ),
    onSettled: () => cache.invalidateQueries({ queryKey: ["structures"] }),
  });
}

/** What corrections of channels change: everything that is drawn or judged from them. */
function useRefreshManeuver(id: number) {
  const cache = useQueryClient();
  return () =>
    Promise.all(
      [["conditioning", id], ["quality"], ["figure"]].map((queryKey) =>
        cache.invalidateQueries({ queryKey }),
      ),
    );
}

export function useTakeCorrections(id: number) {
  return useMutation({
    mutationFn: (items: StepRequest[]) =>
      body(
        api.POST("/api/v1/maneuvers/{maneuver_id}/conditioning", {
          params: { path: { maneuver_id: id } },
          body: { items },
        }),
      ),
    onSuccess: useRefreshManeuver(id),
  });
}

export function useUndoCorrection(id: number) {
  return useMutation({
    mutationFn: (step: number) =>
      body(
        api.DELETE("/api/v1/maneuvers/{maneuver_id}/conditioning/{step_id}", {
          params: { path: { maneuver_id: id, step_id: step } },
        }),
      ),
    onSuccess: useRefreshManeuver(id),
  });
}

export function useAssess() {
  const cache = useQueryClient();
  return useMutation({
    mutationFn: (wanted: "begin" | "stop") =>
      wanted === "begin"
        ? body(api.POST("/api/v1/quality/assess", { body: {} }))
        : body(api.DELETE("/api/v1/quality/assess")),
    onSettled: () => cache.invalidateQueries({ queryKey: ["quality"] }),
  });
}

export function useCorrectMode(tableId: number) {
  const cache = useQueryClient();
  return useMutation({
    mutationFn: (wanted: { number: number; name: string; symmetric: boolean; reason: string }) =>
      body(
        api.POST("/api/v1/modal-tables/{modal_table_id}/corrections", {
          params: { path: { modal_table_id: tableId } },
          body: wanted,
        }),
      ),
    onSuccess: () => cache.invalidateQueries(),
  });
}

export function useImportStructure(upload: string, aircraftId: number) {
  const cache = useQueryClient();
  return useMutation({
    mutationFn: (
      wanted: Pick<StructureFilesRequest, "name" | "kind"> & Partial<StructureFilesRequest>,
    ) =>
      body(
        api.POST("/api/v1/uploads/{upload_id}/structure", {
          params: { path: { upload_id: upload } },
          body: {
            axes: "aft right up",
            origin: [0, 0, 0],
            rigid_modes: false,
            ...wanted,
            aircraft_id: aircraftId,
          },
        }),
      ),
    onSuccess: () => cache.invalidateQueries({ queryKey: ["modal-tables"] }),
  });
}

export function useImportFlutterSummary(upload: string, aircraftId: number) {
  const cache = useQueryClient();
  return useMutation({
    mutationFn: (wanted: { name: string; speed_unit: "m/s" | "ft/s" | "in/s" | "kt" | "km/h" }) =>
      body(
        api.POST("/api/v1/uploads/{upload_id}/flutter-summary", {
          params: { path: { upload_id: upload } },
          body: { ...wanted, aircraft_id: aircraftId },
        }),
      ),
    onSuccess: () => cache.invalidateQueries({ queryKey: ["flutter-summaries"] }),
  });
}

/** Cuts maneuvers out of a flight, one after the other; what was cut stays when one is refused. */
export function useCut(flightId: number) {
  const cache = useQueryClient();
  return useMutation({
    mutationFn: async (wanted: CutRequest[]) => {
      const made = [];
      for (const one of wanted) {
        made.push(
          await body(
            api.POST("/api/v1/flights/{flight_id}/maneuvers", {
              params: { path: { flight_id: flightId } },
              body: one,
            }),
          ),
        );
      }
      return made;
    },
    onSettled: () =>
      Promise.all(
        [["flight", flightId, "found"], ["maneuvers"], ["quality"], ["figure", "envelope"]].map(
          (queryKey) => cache.invalidateQueries({ queryKey }),
        ),
      ),
  });
}

export function useImportResponses(upload: string, aircraftId: number) {
  const cache = useQueryClient();
  return useMutation({
    mutationFn: (
      wanted: Pick<ResponsesRequest, "name" | "response_unit" | "force_unit"> &
        Partial<ResponsesRequest>,
    ) =>
      body(
        api.POST("/api/v1/uploads/{upload_id}/responses", {
          params: { path: { upload_id: upload } },
          body: {
            fuel: 0,
            axes: "aft right up",
            origin: [0, 0, 0],
            ...wanted,
            aircraft_id: aircraftId,
          },
        }),
      ),
    onSuccess: () => cache.invalidateQueries({ queryKey: ["measured-responses"] }),
  });
}

export function useKeepFoundModes(responsesId: number) {
  const cache = useQueryClient();
  return useMutation({
    mutationFn: (wanted: {
      name: string;
      low_hz?: number;
      high_hz?: number;
      order: number;
      keep: number[];
      like_id: number | null;
    }) =>
      body(
        api.POST("/api/v1/measured-responses/{responses_id}/modes", {
          params: { path: { responses_id: responsesId } },
          body: wanted,
        }),
      ),
    onSuccess: () => cache.invalidateQueries({ queryKey: ["modal-tables"] }),
  });
}
