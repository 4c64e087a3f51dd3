import { Anchor, Group, Tabs } from "@mantine/core";
import { useIntersection } from "@mantine/hooks";
import { Link, useLocation } from "@tanstack/react-router";
import { useEffect, useState, type ReactNode } from "react";

/** Title and content by section; a section without an entry is not shown. */
export type SectionContents<Name extends string> = Partial<
  Record<Name, readonly [title: string, content: ReactNode]>
>;

interface Props<Tab extends string, Name extends string> {
  label: string;
  /** Tabs with their sections, and the titles of the tabs. */
  sections: Readonly<Record<Tab, readonly Name[]>>;
  titles: Readonly<Record<Tab, string>>;
  contents: SectionContents<Name>;
  tab: Tab;
  onTab: (tab: Tab) => void;
}

/** Tabs of a page, each of one or more sections, which have an address by their hash. */
export function SectionTabs<Tab extends string, Name extends string>({
  label,
  sections,
  titles,
  contents,
  tab,
  onTab,
}: Props<Tab, Name>) {
  const names = Object.keys(sections) as Tab[];
  return (
    <Tabs
      mt="lg"
      miw={0}
      value={tab}
      onChange={(next) => {
        const name = names.find((one) => one === next);
        if (name !== undefined) onTab(name);
      }}
    >
      <Tabs.List aria-label={label}>
        {names.map((name) => (
          <Tabs.Tab key={name} value={name} data-testid={`tab-${name}`}>
            {titles[name]}
          </Tabs.Tab>
        ))}
      </Tabs.List>
      <Tabs.Panel value={tab} pt="md">
        <Sections key={tab} names={sections[tab]} contents={contents} />
      </Tabs.Panel>
    </Tabs>
  );
}

interface SectionsProps<Name extends string> {
  names: readonly Name[];
  contents: SectionContents<Name>;
}

/** Sections one below the other, with links to each if there are several. */
export function Sections<Name extends string>({ names, contents }: SectionsProps<Name>) {
  const { hash } = useLocation();
  const shown = names.flatMap((name) => {
    const found = contents[name];
    return found === undefined ? [] : [{ name, title: found[0], content: found[1] }];
  });
  return (
    <div className="stack">
      {shown.length > 1 && (
        <Group component="nav" aria-label="Sections" gap="md" className="no-print">
          {shown.map(({ name, title }) => (
            <Anchor
              key={name}
              fz="sm"
              className="link"
              renderRoot={(props) => <Link to="." search hash={name} {...props} />}
            >
              {title}
            </Anchor>
          ))}
        </Group>
      )}
      {shown.map(({ name, title, content }, place) => (
        <LazySection key={name} name={name} title={title} isLoaded={place === 0} hash={hash}>
          {content}
        </LazySection>
      ))}
    </div>
  );
}

interface LazyProps {
  name: string;
  title: string;
  isLoaded: boolean;
  hash: string;
  children: ReactNode;
}

/** Content that is loaded as soon as it is near the window, or its address is opened. */
function LazySection({ name, title, isLoaded, hash, children }: LazyProps) {
  const { ref, entry } = useIntersection<HTMLElement>({ rootMargin: "200px 0px" });
  const [wasNear, setNear] = useState(isLoaded);
  const isNear = wasNear || hash === name || entry?.isIntersecting === true;
  if (isNear && !wasNear) setNear(true);
  useEffect(() => {
    if (hash === name) document.getElementById(name)?.scrollIntoView();
  }, [hash, name]);
  return (
    <section ref={ref} id={name} aria-label={title} className="lazy-section" data-loaded={isNear}>
      {isNear && children}
    </section>
  );
}
