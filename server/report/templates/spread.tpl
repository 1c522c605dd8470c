{{%AUTOESCAPE context="HTML"}}
<svg class="spread" viewBox="0 0 {{WIDTH}} {{HEIGHT}}" width="{{WIDTH}}" height="{{HEIGHT}}" role="img" aria-label="{{LABEL}}" font-family="system-ui, sans-serif" font-size="11">
{{#LINE}}<text class="axis" x="20" y="{{Y}}" text-anchor="end" dominant-baseline="central">{{NAME}}</text><line class="base" x1="{{X0}}" x2="{{X1}}" y1="{{Y}}" y2="{{Y}}"/><line class="zero" x1="{{ZERO}}" x2="{{ZERO}}" y1="{{TOP}}" y2="{{BOTTOM}}"/>{{#LIMIT}}<line class="limit" x1="{{X}}" x2="{{X}}" y1="{{TOP}}" y2="{{BOTTOM}}"/>{{/LIMIT}}<rect class="box" x="{{BOX_X}}" y="{{TOP}}" width="{{BOX_W}}" height="{{BOX_H}}"/><line class="median" x1="{{MEDIAN}}" x2="{{MEDIAN}}" y1="{{TOP}}" y2="{{BOTTOM}}"/><path class="dots" d="{{DOTS}}"/>{{#OUT}}<path class="dots out" d="{{D}}"/>{{/OUT}}<text class="axis" x="{{TEXT_X}}" y="{{Y}}" dominant-baseline="central">{{TEXT}}</text>
{{/LINE}}
</svg>
