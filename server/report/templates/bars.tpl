{{%AUTOESCAPE context="HTML"}}
<svg class="bars" viewBox="0 0 {{WIDTH}} {{HEIGHT}}" width="{{WIDTH}}" height="{{HEIGHT}}" role="img" aria-label="{{LABEL}}" font-family="system-ui, sans-serif" font-size="11">
{{#GRID}}<line class="grid" x1="{{X1}}" x2="{{X2}}" y1="{{Y}}" y2="{{Y}}" stroke="#dddddd"/><text class="axis" x="{{X0}}" y="{{Y}}" text-anchor="end" dominant-baseline="central">{{TEXT}}</text>
{{/GRID}}
{{#USED}}<path class="bar" d="{{D}}"/>{{/USED}}
{{#BAR}}<rect class="bar {{STATE}}" x="{{X}}" y="{{Y}}" width="{{W}}" height="{{H}}" rx="2"><title>{{TITLE}}</title></rect>
{{/BAR}}
<g class="axis" text-anchor="middle">{{#NAMED}}<text x="{{X}}" y="{{Y}}">{{TEXT}}</text>{{/NAMED}}</g>
</svg>
