import { Tooltip } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { useState, type ReactNode } from "react";
import { meaningQuery } from "../../api/queries";
import { useDisplayUnits } from "../../api/units";

/** What a name stands for, from the glossary, when it is pointed at. */
export function SymbolTooltip({ name, children }: { name: string; children: ReactNode }) {
  const [pointed, setPointed] = useState(false);
  const { data } = useQuery({ ...meaningQuery(name, useDisplayUnits()), enabled: pointed });
  const unit = data?.display_unit ?? "";
  const shown = unit === "" || unit === "1" ? "" : ` [${unit}]`;
  const label = data == null ? name : `${data.label}: ${data.meaning}${shown}`;
  return (
    <Tooltip label={label} multiline maw={320}>
      <span
        onPointerEnter={() => {
          setPointed(true);
        }}
      >
        {children}
      </span>
    </Tooltip>
  );
}
