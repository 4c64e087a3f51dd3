import { Modal, Text, TextInput } from "@mantine/core";
import { useDebouncedValue } from "@mantine/hooks";
import { useInfiniteQuery, useQuery } from "@tanstack/react-query";
import { useNavigate } from "@tanstack/react-router";
import { useEffect, useEffectEvent, useRef, useState, type KeyboardEvent } from "react";
import {
  batchesQuery,
  designsQuery,
  glossaryQuery,
  maneuversQuery,
  runListQuery,
  searchesQuery,
  structuresQuery,
  decisionsQuery,
} from "../../api/queries";
import { useDisplayUnits } from "../../api/units";
import { flightName } from "../../lib/text/format";
import { VIEWS } from "../../views";
import { SearchIcon } from "../display/icons";

interface Found {
  key: string;
  label: string;
  kind: string;
  open: () => void;
}

const MOST = 8;

/** Command palette: opens a page, record or symbol by a part of its name. */
export default function Palette({ onClose }: { onClose: () => void }) {
  const [typed, setTyped] = useState("");
  const [active, setActive] = useState(0);
  const { found, isSettled } = useFound(typed.trim());
  const at = Math.min(active, found.length - 1);
  const choose = (one: Found | undefined) => {
    if (one === undefined) return;
    onClose();
    one.open();
  };
  // Enter before the matches have arrived opens the first of them.
  const isAwaited = useRef(false);
  const openAwaited = useEffectEvent(() => {
    if (isAwaited.current) choose(found[0]);
    isAwaited.current = false;
  });
  useEffect(() => {
    if (isSettled) openAwaited();
  }, [isSettled]);
  const pressed = (event: KeyboardEvent) => {
    if (event.key === "Enter") {
      event.preventDefault();
      if (isSettled) choose(found[at]);
      else isAwaited.current = true;
      return;
    }
    const step = event.key === "ArrowDown" ? 1 : event.key === "ArrowUp" ? -1 : 0;
    if (step === 0 || found.length === 0) return;
    event.preventDefault();
    setActive((at + step + found.length) % found.length);
  };
  return (
    <Modal
      opened
      onClose={onClose}
      withCloseButton={false}
      padding={0}
      size="lg"
      yOffset="12vh"
      aria-label="Find"
      data-testid="palette"
    >
      <TextInput
        size="md"
        variant="unstyled"
        px="md"
        aria-label="Find a page, record or symbol"
        placeholder="Page, maneuver, run number, structure, decision, design, symbol"
        leftSection={<SearchIcon />}
        data-autofocus
        data-testid="palette-text"
        role="combobox"
        aria-expanded={true}
        aria-controls="palette-found"
        aria-activedescendant={found[at] === undefined ? undefined : `palette-${found[at].key}`}
        value={typed}
        onKeyDown={pressed}
        onChange={(event) => {
          setTyped(event.currentTarget.value);
          setActive(0);
          isAwaited.current = false;
        }}
      />
      <div role="listbox" id="palette-found" aria-label="Found" className="palette-found">
        {found.map((one, index) => (
          <div
            key={one.key}
            id={`palette-${one.key}`}
            role="option"
            tabIndex={-1}
            aria-selected={index === at}
            className="palette-line"
            onClick={() => {
              choose(one);
            }}
            onMouseMove={() => {
              setActive(index);
            }}
          >
            <span>{one.label}</span>
            <span className="quiet">{one.kind}</span>
          </div>
        ))}
        {found.length === 0 && (
          <Text size="sm" className="quiet" p="md">
            No match for “{typed}”.
          </Text>
        )}
      </div>
    </Modal>
  );
}

/** What matches, and whether it is all: the matches of what is typed arrive later. */
function useFound(typed: string): { found: Found[]; isSettled: boolean } {
  const navigate = useNavigate();
  const [search] = useDebouncedValue(typed, 200);
  const asked = search === "" ? undefined : search;
  const enabled = asked !== undefined;
  const maneuvers = useInfiniteQuery({
    ...maneuversQuery({ search: asked }, "label", MOST),
    enabled,
  });
  const runs = useInfiniteQuery({ ...runListQuery({ search: asked }, "-id", MOST), enabled });
  const glossary = useQuery({ ...glossaryQuery(useDisplayUnits()), enabled });
  const structures = useQuery({ ...structuresQuery(), enabled });
  const decisions = useQuery({ ...decisionsQuery({}), enabled });
  const designs = useQuery({ ...designsQuery, enabled });
  const batches = useQuery({ ...batchesQuery, enabled });
  const searches = useQuery({ ...searchesQuery, enabled });
  const has = (text: string) => text.toLowerCase().includes(typed.toLowerCase());

  const views = VIEWS.filter((view) => has(view.label)).map((view) => ({
    key: view.key,
    label: view.label,
    kind: "page",
    open: () => void navigate(view),
  }));
  const queries = [maneuvers, runs, glossary, structures, decisions, designs, batches, searches];
  const isSettled = search === typed && queries.every((one) => !one.isFetching);
  if (!enabled) return { found: views, isSettled };
  const named = <Item extends { id: number }>(
    items: Item[] | undefined,
    name: (item: Item) => string,
    kind: string,
    open: (id: number) => void,
  ) =>
    (items ?? [])
      .filter((item) => has(name(item)))
      .slice(0, MOST)
      .map((item) => ({
        key: `${kind.replaceAll(" ", "-")}-${item.id}`,
        label: name(item),
        kind,
        open: () => {
          open(item.id);
        },
      }));
  const lines = <Item,>(data: { pages: { items: Item[] }[] } | undefined) =>
    data?.pages[0]?.items ?? [];
  const found = [
    ...views,
    ...lines(maneuvers.data).map((one) => ({
      key: `maneuver-${one.id}`,
      label: one.label,
      kind: `maneuver, ${flightName(one.flight_number).toLowerCase()}`,
      open: () => void navigate({ to: "/maneuvers/$id", params: { id: one.id } }),
    })),
    ...lines(runs.data).map((one) => ({
      key: `run-${one.id}`,
      label: `${one.method} run ${one.id}`,
      kind: `${one.maneuver_label}, ${one.state}`,
      open: () => void navigate({ to: "/runs/$id", params: { id: one.id } }),
    })),
    ...named(
      structures.data,
      (one) => one.name,
      "structure",
      (id) => {
        void navigate({ to: "/model-structures/$id", params: { id } });
      },
    ),
    ...named(
      decisions.data,
      (one) => one.proposal.title,
      "decision",
      (id) => {
        void navigate({ to: "/decisions/$id", params: { id } });
      },
    ),
    ...named(
      designs.data,
      (one) => one.name,
      "excitation",
      (id) => {
        void navigate({ to: "/excitation/$id", params: { id } });
      },
    ),
    ...named(
      batches.data?.map(({ batch }) => batch),
      (one) => one.name,
      "batch",
      (id) => {
        void navigate({ to: "/batches/$id", params: { id } });
      },
    ),
    ...named(
      searches.data,
      (one) => one.sentence ?? `${one.method} search ${one.id}`,
      "structure search",
      (id) => {
        void navigate({ to: "/model-structures", search: { id }, hash: "search" });
      },
    ),
    ...(glossary.data ?? [])
      .filter((entry) => has(entry.symbol) || has(entry.meaning))
      .slice(0, MOST)
      .map((entry) => ({
        key: `symbol-${entry.symbol}`,
        label: `${entry.symbol}: ${entry.meaning}`,
        kind: "symbol",
        open: () => void navigate({ to: "/glossary", search: { search: entry.symbol } }),
      })),
  ];
  return { found, isSettled };
}
